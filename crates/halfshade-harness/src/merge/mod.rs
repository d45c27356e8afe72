//! Parts of an experiment joined: errors of all shards, in order the same as those of an undivided run, and times of one machine.

mod agreement;
mod join;
mod loaded;

use crate::{
    HarnessError, Results,
    out_folder::OutFolder,
    part::{Part, Shard},
    report,
};
use agreement::check_agreement;
use join::join;
use loaded::{Loaded, MergedPicture, load};
use std::path::{Path, PathBuf};

/// Joins the parts in `folders`, whose pictures lie beside them.
///
/// # Errors
/// What isn't a part, is damaged, is of another experiment, is there twice, or is missing.
pub fn merge(folders: &[PathBuf]) -> Result<Merged, HarnessError> {
    let parts = folders.iter().map(|folder| load(folder)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = parts.first() else { return Err(HarnessError::input("there is nothing to join")) };
    parts.iter().try_for_each(|part| check_agreement(first, part))?;
    let (mut errors, mut times) = (Vec::new(), None::<&Loaded>);
    for part in &parts {
        match (part.facts.part, times) {
            (Part::Errors(shard), _) => errors.push((shard, part)),
            (Part::Times, None) => times = Some(part),
            (_, other) => return Err(twice(other.unwrap_or(part), part)),
        }
    }
    errors.sort_by_key(|(shard, _)| shard.number);
    check_complete(&errors)?;
    let errors: Vec<&Loaded> = errors.into_iter().map(|(_, part)| part).collect();
    Ok(Merged { results: join(&errors, times)?, pictures: errors.iter().flat_map(|part| part.pictures()).collect() })
}

/// Joined results, not yet written.
#[derive(Debug)]
pub struct Merged {
    /// The results.
    pub results: Results,
    pictures: Vec<MergedPicture>,
}

impl Merged {
    /// Writes results, reports, plots and pictures into `out`, as an undivided run would have.
    ///
    /// # Errors
    /// Pictures that are gone or damaged, before anything is written; files of others in the way.
    pub fn write(&self, out: &Path) -> Result<(), HarnessError> {
        self.pictures.iter().try_for_each(|picture| picture.read().map(drop))?;
        let files = self.pictures.iter().map(|picture| picture.file.clone());
        let planned: Vec<PathBuf> = files.chain(report::files_written(&self.results)).collect();
        let mut folder = OutFolder::open(out, &planned)?;
        for picture in &self.pictures {
            folder.write(&picture.file, &picture.read()?)?;
        }
        report::write_all(&self.results, &mut |file, bytes| folder.write(file, bytes), &report::files_in(out))
    }
}

/// Whether every shard is there once.
fn check_complete(errors: &[(Shard, &Loaded)]) -> Result<(), HarnessError> {
    let Some((first, _)) = errors.first() else {
        return Err(HarnessError::input("these are times alone; they are joined with errors: add all shards"));
    };
    let count = first.count;
    if let Some(pair) = errors.windows(2).find(|pair| pair[0].0.number == pair[1].0.number) {
        return Err(twice(pair[0].1, pair[1].1));
    }
    let is_there = |number: &usize| errors.iter().any(|(shard, _)| shard.number == *number);
    let missing: Vec<String> = (1..=count).filter(|number| !is_there(number)).map(|it| it.to_string()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let problem =
        format!("of {count} shards these are missing: {}; run them with --shard NUMBER/{count}", missing.join(", "));
    Err(HarnessError::input(problem))
}

fn twice(one: &Loaded, other: &Loaded) -> HarnessError {
    let problem = format!("is {} as {} is: give it once", other.facts.part, one.folder.display());
    HarnessError::in_file(&other.folder, problem)
}
