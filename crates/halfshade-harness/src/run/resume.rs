//! Where a run begins: with nothing, with what a journal holds, or at its end.

use super::record::{Known, Record};
use crate::{
    HarnessError, Results,
    journal::{Header, Journal, SCHEMA},
    out_folder::OutFolder,
};
use halfshade_scene::Progress;
use std::path::{Path, PathBuf};

/// Where a run begins.
pub(super) enum Beginning {
    /// There is something to do.
    Open(Box<Record>),
    /// All is done.
    Finished(Box<Results>),
}

impl Beginning {
    /// Opens `out` for a run that writes the files `planned`, and reads what there is to go on with if it is to `resume`.
    pub(super) fn of(
        out: &Path,
        planned: &[PathBuf],
        header: &Header,
        resume: bool,
        progress: &dyn Progress,
    ) -> Result<Self, HarnessError> {
        let folder = OutFolder::open(out, planned)?;
        let path = folder.journal();
        if resume
            && path.exists()
            && let Some((journal, entries)) = Journal::resume(&path, header)?
        {
            let known = Known::of(entries, &folder);
            return Ok(Self::Open(Box::new(Record::kept(folder, journal, known))));
        }
        if resume && folder.holds(Path::new("results.json")) {
            let path = out.join("results.json");
            let results = Results::load(&path)?;
            if let Some(what) = header_of(&results).difference(header) {
                let problem = format!(
                    "cannot resume: the run is finished, and {what}; run without --resume to replace its results"
                );
                return Err(HarnessError::in_file(&path, problem));
            }
            progress.note(&format!("{}: this run is finished, there is nothing to resume", out.display()));
            folder.remove_truths();
            return Ok(Self::Finished(Box::new(results)));
        }
        if resume {
            progress.note("nothing to resume: starting from the beginning");
        } else {
            if path.exists() {
                progress.note(&format!(
                    "{}: an unfinished run is set aside as journal.old; --resume would have gone on with it",
                    path.display()
                ));
            }
            if let Some(what) = named(&folder.replaced(planned)) {
                progress.note(&format!("{}: of an earlier run this one replaces {what}", out.display()));
            }
        }
        let journal = Journal::create(&path, header)?;
        Ok(Self::Open(Box::new(Record::kept(folder, journal, Known::default()))))
    }
}

/// What began a run that has these results; the program is not known from them.
pub(super) fn header_of(results: &Results) -> Header {
    Header {
        schema: SCHEMA.into(),
        experiment_hash: results.experiment_hash.clone(),
        quick: results.quick,
        threads: results.machine.threads,
        revision: results.revision.clone(),
        program: String::new(),
        inputs: results.inputs.clone().unwrap_or_default(),
    }
}

/// Files by name, those in folders below by number; nothing if there are none.
fn named(files: &[PathBuf]) -> Option<String> {
    let is_below = |folder: &str| files.iter().filter(|file| file.starts_with(folder)).count();
    let names = files.iter().filter(|file| file.components().count() == 1).map(|file| file.display().to_string());
    let counted = ["plots", "pictures"].map(|folder| (is_below(folder), folder));
    let counted = counted.into_iter().filter(|(count, _)| *count > 0);
    let all: Vec<String> = names.chain(counted.map(|(count, folder)| format!("{count} in {folder}"))).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_replaced_is_told_in_a_line() {
        let files = ["results.json", "report.md", "plots/a.svg", "pictures/a/b.exr", "pictures/a/b.png"];
        let expected = "results.json, report.md, 1 in plots, 2 in pictures";
        assert_eq!(named(&files.map(PathBuf::from)).as_deref(), Some(expected));
        assert_eq!(named(&[]), None);
    }
}
