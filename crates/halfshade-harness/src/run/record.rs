//! Measurements that a run has already, and the folder in which they are kept.

use crate::{
    HarnessError, Results,
    image_metrics::Similarity,
    journal::{Entry, Journal},
    out_folder::OutFolder,
    report,
    results::{PictureFiles, Run, Sample},
};
use halfshade_scene::cache::Cache;
use std::{collections::HashMap, path::Path};

/// Measurements by [`Run::key`].
#[derive(Default)]
pub(super) struct KnownRuns {
    scored: HashMap<String, Vec<Run>>,
    samples: HashMap<String, Vec<Sample>>,
    pictured: HashMap<String, (PictureFiles, Similarity)>,
    truths: Vec<PictureFiles>,
}

/// Measurements of a run, and the place where every step is kept, if there is one.
#[derive(Default)]
pub(super) struct Record {
    place: Option<(OutFolder, Journal)>,
    known: KnownRuns,
}

impl KnownRuns {
    /// Pictures that are gone or were changed are drawn again.
    pub(super) fn of(entries: Vec<Entry>, folder: &OutFolder) -> Self {
        let is_there = |files: &PictureFiles| files.all().all(|file| folder.holds(Path::new(file)));
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

impl Record {
    /// One that is kept.
    pub(super) fn kept(folder: OutFolder, journal: Journal, known: KnownRuns) -> Self {
        Self { place: Some((folder, journal)), known }
    }

    /// Whether anything is written.
    pub(super) fn is_kept(&self) -> bool {
        self.place.is_some()
    }

    /// Cache of truths until the run is finished.
    pub(super) fn truth_cache(&self) -> Cache {
        self.place.as_ref().map_or_else(Cache::disabled, |(folder, _)| folder.truths())
    }

    /// Scores of a variant, one against each reference, or why there are none.
    pub(super) fn scored(&self, key: &str) -> Option<&[Run]> {
        self.known.scored.get(key).map(Vec::as_slice)
    }

    /// Timed frames of a variant.
    pub(super) fn samples(&self, key: &str) -> &[Sample] {
        self.known.samples.get(key).map_or(&[], Vec::as_slice)
    }

    /// The picture of a variant.
    pub(super) fn picture(&self, key: &str) -> Option<&(PictureFiles, Similarity)> {
        self.known.pictured.get(key)
    }

    /// The picture of the truth.
    pub(super) fn truth_picture(&self, scene: &str, frame: usize) -> Option<&PictureFiles> {
        self.known.truths.iter().find(|files| files.scene == scene && files.frame == frame)
    }

    pub(super) fn add_scored(&mut self, key: &str, runs: Vec<Run>) -> Result<(), HarnessError> {
        self.append(|| Entry::Scored(runs.clone()))?;
        self.known.scored.insert(key.to_owned(), runs);
        Ok(())
    }

    pub(super) fn add_sample(&mut self, key: &str, sample: Sample) -> Result<(), HarnessError> {
        self.append(|| Entry::Timed { key: key.to_owned(), sample })?;
        self.known.samples.entry(key.to_owned()).or_default().push(sample);
        Ok(())
    }

    pub(super) fn add_picture(
        &mut self,
        key: &str,
        files: PictureFiles,
        similarity: Similarity,
    ) -> Result<(), HarnessError> {
        self.append(|| Entry::Pictured { key: Some(key.to_owned()), files: files.clone(), similarity })?;
        self.known.pictured.insert(key.to_owned(), (files, similarity));
        Ok(())
    }

    pub(super) fn add_truth_picture(&mut self, files: PictureFiles) -> Result<(), HarnessError> {
        let similarity = Similarity::default();
        self.append(|| Entry::Pictured { key: None, files: files.clone(), similarity })?;
        self.known.truths.push(files);
        Ok(())
    }

    /// Writes a file of the run.
    pub(super) fn write(&mut self, file: &Path, bytes: &[u8]) -> Result<(), HarnessError> {
        self.place.as_mut().map_or(Ok(()), |(folder, _)| folder.write(file, bytes))
    }

    /// Notes the hashes of a part's pictures and of its results, by which damage is known when parts are joined.
    pub(super) fn seal(&self, results: &mut Results) -> Result<(), HarnessError> {
        let Some(facts) = &mut results.part else { return Ok(()) };
        if let Some((folder, _)) = &self.place {
            let files = results.pictures.iter().flat_map(PictureFiles::all);
            let hash = |file: &str| Some((file.to_owned(), folder.hash(Path::new(file))?));
            facts.files = files.filter_map(hash).collect();
        }
        results.seal()
    }

    /// Writes the results and their company; the journal has had its day.
    pub(super) fn finish(self, results: &Results) -> Result<(), HarnessError> {
        let Some((mut folder, journal)) = self.place else { return Ok(()) };
        let path = folder.path().to_owned();
        report::write_all(results, &mut |file, bytes| folder.write(file, bytes), &report::files_in(&path))?;
        folder.remove_truths();
        journal.finish()
    }

    fn append(&mut self, entry: impl FnOnce() -> Entry) -> Result<(), HarnessError> {
        self.place.as_mut().map_or(Ok(()), |(_, journal)| journal.append(&entry()))
    }
}
