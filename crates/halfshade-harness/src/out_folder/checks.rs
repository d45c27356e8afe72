//! Whether a folder can be a run's: what is in the way, and the lock.

use crate::HarnessError;
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::ErrorKind,
    path::Path,
};

/// Advice about something that is in the way.
pub(super) const ELSEWHERE: &str = "move it away, or choose another folder with --out";

/// Refuses a place where no folder is or can be made.
pub(super) fn check_folder(path: &Path) -> Result<(), HarnessError> {
    for place in path.ancestors() {
        let problem = match (fs::symlink_metadata(place), fs::metadata(place)) {
            (Ok(_), Ok(metadata)) if metadata.is_dir() => return Ok(()),
            (Ok(metadata), Err(_)) if metadata.is_symlink() => "this is a link that leads to no folder",
            (Ok(_), _) => "a folder is needed here, and this is none",
            (Err(error), _) if is_absent(&error) => continue,
            (Err(source), _) => return Err(HarnessError::io(place, "read", source)),
        };
        return Err(HarnessError::in_file(place, format!("{problem}; {ELSEWHERE}")));
    }
    Ok(())
}

/// Refuses a private folder that is none, and what is in the place of something that a run keeps there. Links are not
/// followed: what they lead to isn't a run's own.
pub(super) fn check_private(private: &Path) -> Result<(), HarnessError> {
    let [lock, list, journal, truths] = ["lock", "written", "journal.jsonl", "truth"].map(|name| private.join(name));
    for (path, is_folder) in [(private, true), (&lock, false), (&list, false), (&journal, false), (&truths, true)] {
        match fs::symlink_metadata(path) {
            Ok(metadata) if if is_folder { metadata.is_dir() } else { metadata.is_file() } => {}
            Ok(_) => {
                let kind = if is_folder { "folder" } else { "file" };
                let problem = format!("a run keeps a {kind} of this name for itself, and this is none; {ELSEWHERE}");
                return Err(HarnessError::in_file(path, problem));
            }
            Err(error) if is_absent(&error) => {}
            Err(source) => return Err(HarnessError::io(path, "read", source)),
        }
    }
    Ok(())
}

/// Takes the lock `file` of the folder at `path`, if no other run has it.
pub(super) fn lock(path: &Path, file: &Path) -> Result<File, HarnessError> {
    let fail = |source| HarnessError::io(file, "lock", source);
    let lock = OpenOptions::new().create(true).append(true).open(file).map_err(fail)?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => {
            let problem = "another run is writing into this folder; wait for it, or choose another folder with --out";
            Err(HarnessError::in_file(path, problem))
        }
        // Some network file systems know no locks: then the user must take care.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(lock),
        Err(TryLockError::Error(source)) => Err(fail(source)),
    }
}

pub(super) fn is_absent(error: &std::io::Error) -> bool {
    // The second: below something that is no folder, which is told when the folder is to be made.
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}
