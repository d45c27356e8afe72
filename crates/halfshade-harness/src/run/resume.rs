//! The start of a run: with nothing, with a journal, or at its end, where only files that have gone since are written again.

use super::record::{KnownRuns, Record};
use crate::{
    HarnessError, Results,
    journal::{Header, Journal, SCHEMA},
    out_folder::OutFolder,
    report,
    results::PictureFiles,
};
use halfshade_scene::Progress;
use std::path::{Path, PathBuf};

/// Start of a run.
pub(super) enum RunStart {
    /// There is something to do.
    Open(Box<Record>),
    /// All is done.
    Finished(Box<Results>),
}

impl RunStart {
    /// Opens `out` for a run that writes the files `planned`, and reads what there is to go on with if it is to `resume`.
    pub(super) fn of(
        out: &Path,
        planned: &[PathBuf],
        header: &Header,
        resume: bool,
        progress: &dyn Progress,
    ) -> Result<Self, HarnessError> {
        let mut folder = OutFolder::open(out, planned)?;
        let path = folder.journal();
        if resume
            && path.exists()
            && let Some((journal, entries)) = Journal::resume(&path, header)?
        {
            let known = KnownRuns::of(entries, &folder);
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
            let name = out.display();
            match named(&restore(&mut folder, &results)?) {
                None => progress.note(&format!("{name}: this run is finished, there is nothing to resume")),
                Some(what) => {
                    progress.note(&format!("{name}: this run is finished; written again from its results: {what}"))
                }
            }
            if let Some(what) = named(&missing_pictures(&folder, &results)) {
                progress
                    .note(&format!("{name}: gone is {what}; pictures are drawn again by a run without --resume only"));
            }
            folder.remove_truths();
            return Ok(Self::Finished(Box::new(results)));
        }
        if resume {
            progress.note("nothing to resume: starting from the beginning");
        }
        if path.exists() {
            let old = Journal::set_aside(&path)?;
            // Without its first line there was nothing to go on with.
            let hint = if resume { "" } else { "; --resume would have gone on with it" };
            progress.note(&format!("{}: the journal of an unfinished run is now here{hint}", old.display()));
        }
        if !resume && let Some(what) = named(&folder.replaced(planned)) {
            progress.note(&format!("{}: of an earlier run this one replaces {what}", out.display()));
        }
        let journal = Journal::create(&path, header)?;
        Ok(Self::Open(Box::new(Record::kept(folder, journal, KnownRuns::default()))))
    }
}

/// Writes again what a finished run wrote from its results and is there no more; returns what that is.
fn restore(folder: &mut OutFolder, results: &Results) -> Result<Vec<PathBuf>, HarnessError> {
    let mut shown = results.clone();
    shown.pictures.retain(|files| folder.holds(Path::new(&files.png)));
    let mut written = Vec::new();
    let path = folder.path().to_owned();
    let mut write = |file: &Path, bytes: &[u8]| {
        if !folder.holds(file) {
            folder.write(file, bytes)?;
            written.push(file.to_owned());
        }
        Ok(())
    };
    report::write_all(&shown, &mut write, &report::files_in(&path))?;
    Ok(written)
}

/// Pictures of a finished run that are there no more.
fn missing_pictures(folder: &OutFolder, results: &Results) -> Vec<PathBuf> {
    let files = results.pictures.iter().flat_map(PictureFiles::all);
    files.map(PathBuf::from).filter(|file| !folder.holds(file)).collect()
}

/// Header of a run that has these results; they don't tell the program.
pub(super) fn header_of(results: &Results) -> Header {
    Header {
        schema: SCHEMA.into(),
        experiment_hash: results.experiment_hash.clone(),
        part: results.part.as_ref().map(|facts| facts.part).unwrap_or_default(),
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
