//! The folder that a run writes into, which may hold what others put there.
//!
//! Nothing is replaced there but what earlier runs wrote and nobody has changed since: a list of all that was written,
//! by content, tells. What a run keeps for itself lies in the folder [`PRIVATE`] below it: that list, the journal, the
//! truths of an unfinished run, and a lock, which the system takes back even from a run that was killed.

use crate::{
    HarnessError,
    output::{TEMPORARY, prepare_folder, temporary, write_atomically},
};
use halfshade_scene::{Cache, cache};
use serde::{Deserialize, Serialize};
use std::{
    collections::HashMap,
    fs::{self, File, OpenOptions, TryLockError},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

/// What a run keeps for itself, below its folder.
pub const PRIVATE: &str = ".halfshade";

/// The first line of the list of what was written.
const SCHEMA: &str = "halfshade.written/1";

/// A folder that no other run writes into.
#[derive(Debug)]
pub struct OutFolder {
    path: PathBuf,
    written: Written,
    list: File,
    /// Held until this is dropped.
    _lock: File,
}

/// Hashes of all contents that files were given, by path below the folder, with `/`.
#[derive(Debug, Default)]
struct Written(HashMap<String, Vec<String>>);

/// A line of the list.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    path: String,
    blake3: String,
}

/// What lies where a file is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Free,
    /// What a run wrote.
    Ours,
    /// Anything else.
    Foreign,
}

impl OutFolder {
    /// Makes `path` the folder of one run that will write the files `planned`, relative to it, and proves that files can
    /// be written there. Nothing is touched if another run is at work there or where something else is in the way of a
    /// planned file.
    pub fn open(path: &Path, planned: &[PathBuf]) -> Result<Self, HarnessError> {
        let private = path.join(PRIVATE);
        match fs::symlink_metadata(&private) {
            Ok(metadata) if metadata.is_dir() => {}
            Ok(_) => {
                let problem = "a run keeps its journal in a folder of this name, and this is none; move it away, or \
                               choose another folder with --out";
                return Err(HarnessError::in_file(&private, problem));
            }
            Err(error) if is_absent(&error) => {}
            Err(source) => return Err(HarnessError::io(&private, "read", source)),
        }
        let known_lock = if private.join("lock").exists() { Some(lock(path)?) } else { None };
        let list = private.join("written");
        let written = Written::load(&list)?;
        let mut foreign = Vec::new();
        for file in planned {
            if written.place(path, file)? == Place::Foreign {
                foreign.push(path.join(file));
            }
        }
        if let Some(first) = foreign.first() {
            let more = if foreign.len() > 1 { format!(" (and {} more)", foreign.len() - 1) } else { String::new() };
            let problem = format!(
                "this is in the way{more}: no run into this folder wrote it, or it was changed since; move it away, or \
                 choose another folder with --out"
            );
            return Err(HarnessError::in_file(first, problem));
        }
        // What a killed run leaves of this is found again, and nobody else's.
        prepare_folder(&private)?;
        let lock = known_lock.map_or_else(|| lock(path), Ok)?;
        if !list.exists() {
            write_atomically(&list, format!("{SCHEMA}\n").as_bytes())?;
        }
        let opened = OpenOptions::new().append(true).open(&list).and_then(|mut file| {
            // Ends a line that was cut off when a run was killed.
            file.write_all(b"\n")?;
            Ok(file)
        });
        let list = opened.map_err(|source| HarnessError::io(&list, "write", source))?;
        let folder = Self { path: path.to_owned(), written, list, _lock: lock };
        folder.remove_own(&folder.private(), |name| name.starts_with(TEMPORARY));
        Ok(folder)
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn private(&self) -> PathBuf {
        self.path.join(PRIVATE)
    }

    /// Where the journal is.
    pub fn journal(&self) -> PathBuf {
        self.private().join("journal.jsonl")
    }

    /// Truths are kept until the run is complete: resuming would otherwise trace them again.
    pub fn truths(&self) -> Cache {
        Cache::open(Some(self.private().join("truth")))
    }

    /// Removes the truths, entry by entry.
    pub fn remove_truths(&self) {
        let folder = self.private().join("truth");
        if fs::symlink_metadata(&folder).is_ok_and(|metadata| metadata.is_dir()) {
            self.remove_own(&folder, cache::is_entry_name);
            // What isn't empty stays, and isn't ours.
            let _ = fs::remove_dir(&folder);
        }
    }

    /// Removes the plain files in `folder` whose names say that they are ours. What can't be removed only wastes space.
    fn remove_own(&self, folder: &Path, is_own: impl Fn(&str) -> bool) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_file && entry.file_name().to_str().is_some_and(&is_own) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// How many of the files `planned` an earlier run has written.
    pub fn replaced(&self, planned: &[PathBuf]) -> Vec<PathBuf> {
        let is_ours = |file: &&PathBuf| self.written.place(&self.path, file).is_ok_and(|place| place == Place::Ours);
        planned.iter().filter(is_ours).cloned().collect()
    }

    /// Whether a run wrote `file` as it is.
    pub fn holds(&self, file: &Path) -> bool {
        self.written.place(&self.path, file).is_ok_and(|place| place == Place::Ours)
    }

    /// Writes `bytes` to `file`, relative to the folder, whole or not at all, and nothing that isn't ours is replaced.
    pub fn write(&mut self, file: &Path, bytes: &[u8]) -> Result<(), HarnessError> {
        let path = self.path.join(file);
        let fail = |source| HarnessError::io(&path, "write", source);
        if self.written.place(&self.path, file)? == Place::Foreign {
            return Err(HarnessError::in_file(&path, "something else has been put here; move it away"));
        }
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|source| HarnessError::io(parent, "create", source))?;
        }
        // Known before it is there: what a killed run leaves is ours as well.
        let line = Line { path: name(file), blake3: blake3::hash(bytes).to_hex().to_string() };
        self.written.note(&line);
        let mut text = serde_json::to_vec(&line).map_err(|error| fail(error.into()))?;
        text.push(b'\n');
        self.list
            .write_all(&text)
            .map_err(|source| HarnessError::io(&self.private().join("written"), "write", source))?;
        // A link stays, and what it leads to is written.
        let target = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
        let beside = target.parent().unwrap_or(&self.path).to_owned();
        let write_in = |folder: &Path| -> std::io::Result<()> {
            let mut file = temporary(folder)?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            file.persist(&target).map_err(|error| error.error)?;
            Ok(())
        };
        match write_in(&self.private()) {
            // A folder below may lie on another disk.
            Err(error) if error.kind() == ErrorKind::CrossesDevices => write_in(&beside).map_err(fail),
            result => result.map_err(fail),
        }
    }
}

/// Takes the lock of the folder at `path`, if no other run has it.
fn lock(path: &Path) -> Result<File, HarnessError> {
    let file = path.join(PRIVATE).join("lock");
    let fail = |source| HarnessError::io(&file, "lock", source);
    let lock = OpenOptions::new().create(true).append(true).open(&file).map_err(fail)?;
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

fn is_absent(error: &std::io::Error) -> bool {
    // The second: below something that is no folder, which is told when the folder is to be made.
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// A path below the folder, the same on every system.
fn name(file: &Path) -> String {
    file.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}

impl Written {
    fn load(path: &Path) -> Result<Self, HarnessError> {
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if is_absent(&error) => return Ok(Self::default()),
            Err(source) => return Err(HarnessError::io(path, "read", source)),
        };
        let mut lines = text.lines();
        if lines.next() != Some(SCHEMA) {
            let problem = "not the list of files that this version writes; move it away: what earlier runs wrote is then \
                           taken for somebody else's";
            return Err(HarnessError::in_file(path, problem));
        }
        let mut written = Self::default();
        // A line that was damaged or cut off only makes a file look like somebody else's.
        lines.filter_map(|line| serde_json::from_str(line).ok()).for_each(|line: Line| written.note(&line));
        Ok(written)
    }

    fn note(&mut self, line: &Line) {
        let hashes = self.0.entry(line.path.clone()).or_default();
        if !hashes.contains(&line.blake3) {
            hashes.push(line.blake3.clone());
        }
    }

    /// What lies at `file` below `folder`.
    fn place(&self, folder: &Path, file: &Path) -> Result<Place, HarnessError> {
        let path = folder.join(file);
        // Folders on the way, which may be links.
        let above = file.ancestors().skip(1).map(|above| folder.join(above));
        for above in above {
            match (fs::symlink_metadata(&above), fs::metadata(&above)) {
                (Ok(_), Ok(metadata)) if metadata.is_dir() => {}
                (Ok(_), _) => {
                    let problem = "a folder is needed here, and this is none; move it away, or choose another --out";
                    return Err(HarnessError::in_file(&above, problem));
                }
                (Err(error), _) if is_absent(&error) => {}
                (Err(source), _) => return Err(HarnessError::io(&above, "read", source)),
            }
        }
        match fs::symlink_metadata(&path) {
            Ok(_) => {}
            Err(error) if is_absent(&error) => return Ok(Place::Free),
            Err(source) => return Err(HarnessError::io(&path, "write", source)),
        }
        // Also of a link that leads nowhere it isn't known where it should lead.
        let Some(hashes) = self.0.get(&name(file)).filter(|_| path.is_file()) else { return Ok(Place::Foreign) };
        let bytes = fs::read(&path).map_err(|source| HarnessError::io(&path, "read", source))?;
        let is_ours = hashes.contains(&blake3::hash(&bytes).to_hex().to_string());
        Ok(if is_ours { Place::Ours } else { Place::Foreign })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned() -> Vec<PathBuf> {
        ["results.json", "pictures/a/b.png"].map(PathBuf::from).to_vec()
    }

    fn open(path: &Path) -> Result<OutFolder, String> {
        OutFolder::open(path, &planned()).map_err(|error| error.to_string())
    }

    #[test]
    fn what_a_run_wrote_is_replaced_and_nothing_else() {
        let here = tempfile::tempdir().unwrap();
        let out = here.path().join("new/out");
        let mut folder = open(&out).unwrap();
        assert!(folder.replaced(&planned()).is_empty());
        folder.write(Path::new("results.json"), b"1").unwrap();
        folder.write(Path::new("pictures/a/b.png"), b"picture").unwrap();
        drop(folder);
        let mut folder = open(&out).unwrap();
        assert_eq!(folder.replaced(&planned()), planned());
        folder.write(Path::new("results.json"), b"2").unwrap();
        assert!(folder.holds(Path::new("results.json")));
        drop(folder);
        // Changed by hand: somebody may want it.
        fs::write(out.join("results.json"), "3").unwrap();
        let error = open(&out).unwrap_err();
        assert!(error.contains("results.json: this is in the way:") && error.contains("--out"), "{error}");
        assert_eq!(fs::read(out.join("results.json")).unwrap(), b"3");
        fs::write(out.join("results.json"), "2").unwrap();
        let mut folder = open(&out).unwrap();
        fs::write(out.join("results.json"), "put there meanwhile").unwrap();
        assert!(folder.write(Path::new("results.json"), b"4").is_err());
        assert_eq!(fs::read(out.join("results.json")).unwrap(), b"put there meanwhile");
    }

    #[test]
    fn a_folder_in_which_something_is_in_the_way_is_left_as_it_was() {
        let here = tempfile::tempdir().unwrap();
        for file in ["results.json", "pictures", "pictures/a", ".halfshade"] {
            let out = here.path().join(file.replace('/', "_"));
            fs::create_dir_all(out.join(file).parent().unwrap()).unwrap();
            fs::write(out.join(file), "precious").unwrap();
            let error = open(&out).unwrap_err();
            assert!(error.contains(file) && error.contains("move it away"), "{error}");
            assert_eq!(fs::read(out.join(file)).unwrap(), b"precious");
            assert_eq!(fs::read_dir(&out).unwrap().count(), 1);
        }
        let private = here.path().join("private");
        fs::create_dir_all(private.join(PRIVATE)).unwrap();
        fs::write(private.join(PRIVATE).join("written"), "a diary\n").unwrap();
        assert!(open(&private).unwrap_err().contains("written: not the list"));
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_what_they_lead_to_is_safe() {
        use std::os::unix::fs::symlink;
        let here = tempfile::tempdir().unwrap();
        let (out, elsewhere) = (here.path().join("out"), here.path().join("elsewhere"));
        fs::create_dir_all(&out).unwrap();
        fs::create_dir_all(&elsewhere).unwrap();
        symlink(&elsewhere, out.join("pictures")).unwrap();
        for target in ["precious", "nothing"] {
            fs::write(elsewhere.join("precious"), "precious").unwrap();
            symlink(elsewhere.join(target), out.join("results.json")).unwrap();
            assert!(open(&out).unwrap_err().contains("results.json: this is in the way"));
            fs::remove_file(out.join("results.json")).unwrap();
        }
        let mut folder = open(&out).unwrap();
        folder.write(Path::new("pictures/a/b.png"), b"picture").unwrap();
        assert_eq!(fs::read(elsewhere.join("a/b.png")).unwrap(), b"picture");
        assert!(out.join("pictures").is_symlink());
        // Truths of a private folder that was led elsewhere stay where they are.
        symlink(&elsewhere, out.join(PRIVATE).join("truth")).unwrap();
        let entry = format!("truth-{}.bin", "0".repeat(64));
        fs::write(elsewhere.join(&entry), "precious").unwrap();
        folder.remove_truths();
        assert!(elsewhere.join(&entry).exists() && elsewhere.join("precious").exists());
    }

    #[test]
    fn one_run_at_a_time_and_a_lock_ends_with_its_run() {
        let here = tempfile::tempdir().unwrap();
        let folder = open(here.path()).unwrap();
        let error = open(here.path()).unwrap_err();
        assert!(error.contains("another run is writing into this folder"), "{error}");
        drop(folder);
        open(here.path()).unwrap();
    }

    #[test]
    fn truths_go_one_by_one_and_what_was_put_beside_them_stays() {
        let here = tempfile::tempdir().unwrap();
        let folder = open(here.path()).unwrap();
        let key = cache::CacheKey::new("truth", 1);
        folder.truths().get_or_compute(&key, |_| true, || Ok(7u32)).unwrap();
        let truths = here.path().join(PRIVATE).join("truth");
        assert_eq!(fs::read_dir(&truths).unwrap().count(), 1);
        fs::write(truths.join("notes.txt"), "precious").unwrap();
        folder.remove_truths();
        assert_eq!(fs::read_dir(&truths).unwrap().count(), 1);
        fs::remove_file(truths.join("notes.txt")).unwrap();
        folder.remove_truths();
        assert!(!truths.exists());
    }

    #[test]
    fn a_list_that_was_cut_off_anywhere_still_serves() {
        let here = tempfile::tempdir().unwrap();
        let mut folder = open(here.path()).unwrap();
        folder.write(Path::new("results.json"), b"1").unwrap();
        folder.write(Path::new("pictures/a/b.png"), b"2").unwrap();
        drop(folder);
        let list = here.path().join(PRIVATE).join("written");
        let whole = fs::read(&list).unwrap();
        fs::write(&list, &whole[..whole.len() - 9]).unwrap();
        assert!(open(here.path()).unwrap_err().contains("b.png: this is in the way"));
        fs::remove_file(here.path().join("pictures/a/b.png")).unwrap();
        let mut folder = open(here.path()).unwrap();
        folder.write(Path::new("pictures/a/b.png"), b"3").unwrap();
        drop(folder);
        assert_eq!(open(here.path()).unwrap().replaced(&planned()), planned());
    }
}
