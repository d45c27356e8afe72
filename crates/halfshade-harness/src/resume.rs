//! Where a run begins: with nothing, with what a journal holds, or at its end.

use crate::{
    HarnessError, Results,
    image_metrics::Similarity,
    journal::{Entry, Header, Journal, SCHEMA},
    out_folder::OutFolder,
    results::{PictureFiles, Run, Sample},
};
use halfshade_scene::Progress;
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// Where a run begins.
pub(crate) enum Beginning {
    /// There is something to do.
    Open(Box<Open>),
    /// All is done.
    Finished(Box<Results>),
}

/// What a run has that is to be done.
pub(crate) struct Open {
    pub(crate) folder: OutFolder,
    pub(crate) journal: Journal,
    pub(crate) known: Known,
}

/// What the journal knows already.
#[derive(Default)]
pub(crate) struct Known {
    pub(crate) scored: HashMap<String, Vec<Run>>,
    pub(crate) samples: HashMap<String, Vec<Sample>>,
    pub(crate) pictured: HashMap<String, (PictureFiles, Similarity)>,
    pub(crate) truths: Vec<PictureFiles>,
}

impl Beginning {
    /// Opens `out` for a run that writes the files `planned`, and reads what there is to go on with if it is to `resume`.
    pub(crate) fn of(
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
            return Ok(Self::Open(Box::new(Open { folder, journal, known })));
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
        Ok(Self::Open(Box::new(Open { folder, journal, known: Known::default() })))
    }
}

/// What began a run that has these results.
fn header_of(results: &Results) -> Header {
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

impl Known {
    /// Pictures that are gone or were changed are drawn again.
    fn of(entries: Vec<Entry>, folder: &OutFolder) -> Self {
        let is_there = |files: &PictureFiles| {
            [&files.exr, &files.png].into_iter().chain(&files.error_png).all(|file| folder.holds(Path::new(file)))
        };
        let mut known = Self::default();
        for entry in entries {
            match entry {
                Entry::Scored(runs) => {
                    if let Some(run) = runs.first() {
                        known.scored.insert(run.key(), runs);
                    }
                }
                Entry::Timed { key, sample } => known.samples.entry(key).or_default().push(sample),
                Entry::Pictured { files, .. } if !is_there(&files) => {}
                Entry::Pictured { key: Some(key), files, similarity } => {
                    known.pictured.insert(key, (files, similarity));
                }
                Entry::Pictured { key: None, files, .. } => {
                    // One that was gone and was drawn again is there twice.
                    known.truths.retain(|other| (&other.scene, other.frame) != (&files.scene, files.frame));
                    known.truths.push(files);
                }
            }
        }
        known
    }
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
