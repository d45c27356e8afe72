//! A part as it lies in its folder, and whether it is whole.

use crate::{HarnessError, Results, results::PartFacts};
use std::path::{Path, PathBuf};

/// A part, and where it lies.
pub(super) struct Loaded {
    pub(super) folder: PathBuf,
    pub(super) results: Results,
    pub(super) facts: PartFacts,
}

/// A picture's file, by its part.
#[derive(Debug)]
pub(super) struct MergedPicture {
    folder: PathBuf,
    pub(super) file: PathBuf,
    blake3: String,
}

impl MergedPicture {
    pub(super) fn read(&self) -> Result<Vec<u8>, HarnessError> {
        let path = self.folder.join(&self.file);
        let bytes = std::fs::read(&path).map_err(|source| HarnessError::io(&path, "read", source))?;
        if blake3::hash(&bytes).to_hex().as_str() != self.blake3 {
            return Err(HarnessError::in_file(&path, "damaged: not what its part wrote; copy or run that part again"));
        }
        Ok(bytes)
    }
}

impl Loaded {
    pub(super) fn pictures(&self) -> impl Iterator<Item = MergedPicture> {
        self.facts.files.iter().map(|(file, blake3)| MergedPicture {
            folder: self.folder.clone(),
            file: file.into(),
            blake3: blake3.clone(),
        })
    }
}

/// The part in `folder`, if it is one, and whole.
pub(super) fn load(folder: &Path) -> Result<Loaded, HarnessError> {
    let path = folder.join("results.json");
    let results = Results::load(&path)?;
    let problem = match &results.part {
        None => "is no part of an experiment but all of it: there is nothing to join it with".to_owned(),
        Some(facts) if !results.is_sealed()? => {
            format!("damaged: not what {} wrote; copy or run that part again", facts.part)
        }
        Some(facts) => return Ok(Loaded { folder: folder.to_owned(), facts: facts.clone(), results }),
    };
    Err(HarnessError::in_file(&path, problem))
}
