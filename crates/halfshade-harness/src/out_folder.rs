//! The folder that a run writes into, which may hold what others put there.
//!
//! Nothing is replaced there but what earlier runs wrote and nobody has changed since: a list of all that was written,
//! by content, tells. What a run keeps for itself lies in the folder [`PRIVATE`] below it: that list, the journal, the
//! truths of an unfinished run, and a lock, which the system takes back even from a run that was killed. None of these may
//! be a link. There too only that is removed which its name and the list or its first bytes tell to be a run's own.

mod checks;
mod written;

use crate::{
    HarnessError,
    output::{prepare_folder, temporary_called, write_atomically},
};
use checks::{ELSEWHERE, check_folder, check_private, lock};
use halfshade_scene::{Cache, cache};
use std::{
    fs::{self, File, OpenOptions},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};
use written::{Line, Place, SCHEMA, WrittenFiles, name};

/// Subfolder that a run keeps for itself.
pub const PRIVATE: &str = ".halfshade";

/// Prefix of a file in the private folder until it is whole. The hash of its content follows, which is listed.
const UNFINISHED: &str = "unfinished-";

/// A folder that no other run writes into.
#[derive(Debug)]
pub struct OutFolder {
    path: PathBuf,
    written: WrittenFiles,
    list: File,
    /// Held until this is dropped.
    _lock: File,
}

impl OutFolder {
    /// Makes `path` the folder of one run that will write the files `planned`, relative to it, and proves that files can
    /// be written there. Nothing is touched if another run is at work there or where something else is in the way of a
    /// planned file.
    pub fn open(path: &Path, planned: &[PathBuf]) -> Result<Self, HarnessError> {
        let private = path.join(PRIVATE);
        check_folder(path)?;
        check_private(&private)?;
        let lock_file = private.join("lock");
        let known_lock = if lock_file.exists() { Some(lock(path, &lock_file)?) } else { None };
        let list = private.join("written");
        let written = WrittenFiles::load(&list)?;
        let mut foreign = Vec::new();
        for file in planned {
            if written.place(path, file)? == Place::Foreign {
                foreign.push(path.join(file));
            }
        }
        if let Some(first) = foreign.first() {
            let more = if foreign.len() > 1 { format!(" (and {} more)", foreign.len() - 1) } else { String::new() };
            let problem = format!(
                "this is in the way{more}: no run into this folder wrote it, or it was changed since; {ELSEWHERE}"
            );
            return Err(HarnessError::in_file(first, problem));
        }
        prepare_folder(&private)?;
        let lock = known_lock.map_or_else(|| lock(path, &lock_file), Ok)?;
        let opened = OpenOptions::new().create(true).append(true).open(&list).and_then(|mut file| {
            let is_new = file.metadata()?.len() == 0;
            // The second ends a line that was cut off when a run was killed.
            file.write_all(if is_new { SCHEMA.as_bytes() } else { b"" })?;
            file.write_all(b"\n")?;
            Ok(file)
        });
        let list = opened.map_err(|source| HarnessError::io(&list, "write", source))?;
        let folder = Self { path: path.to_owned(), written, list, _lock: lock };
        folder.remove_own(&private, |path| {
            let name = path.file_name().and_then(|name| name.to_str());
            name.and_then(|name| name.strip_prefix(UNFINISHED)).is_some_and(|hash| folder.written.knows(hash))
        });
        Ok(folder)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn private(&self) -> PathBuf {
        self.path.join(PRIVATE)
    }

    /// Path of the journal.
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
            self.remove_own(&folder, cache::is_entry);
            // A folder that isn't empty stays: the rest in it isn't ours.
            let _ = fs::remove_dir(&folder);
        }
    }

    /// Removes the plain files in `folder` that are ours. What can't be removed only wastes space.
    fn remove_own(&self, folder: &Path, is_own: impl Fn(&Path) -> bool) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.file_type().is_ok_and(|kind| kind.is_file()) && is_own(&entry.path()) {
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

    /// BLAKE3 hash of `file`, if a run wrote it as it is.
    pub fn hash(&self, file: &Path) -> Option<String> {
        let bytes = fs::read(self.path.join(file)).ok().filter(|_| self.holds(file))?;
        Some(blake3::hash(&bytes).to_hex().to_string())
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
        let write = || -> std::io::Result<()> {
            let mut file = temporary_called(&format!("{UNFINISHED}{}", line.blake3), &self.private())?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            file.persist(&target).map_err(|error| error.error)?;
            Ok(())
        };
        match write() {
            // A folder below may lie on another disk.
            Err(error) if error.kind() == ErrorKind::CrossesDevices => write_atomically(&target, bytes),
            result => result.map_err(fail),
        }
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

    #[cfg(unix)]
    #[test]
    fn what_stands_for_something_of_a_run_is_named_and_left() {
        use std::os::unix::fs::symlink;
        let here = tempfile::tempdir().unwrap();
        let elsewhere = here.path().join("elsewhere");
        fs::create_dir(&elsewhere).unwrap();
        for (number, name) in ["", "lock", "written", "journal.jsonl", "truth"].into_iter().enumerate() {
            for (kind, target) in [("linked", elsewhere.as_path()), ("dangling", Path::new("nowhere"))] {
                let out = here.path().join(format!("{kind}{number}"));
                let place = if name.is_empty() { out.join(PRIVATE) } else { out.join(PRIVATE).join(name) };
                fs::create_dir_all(place.parent().unwrap()).unwrap();
                symlink(target, &place).unwrap();
                let error = open(&out).unwrap_err();
                assert!(error.contains(&format!("{}: a run keeps a", place.display())), "{error}");
                assert!(error.ends_with(ELSEWHERE) && place.is_symlink(), "{error}");
                assert_eq!(fs::read_dir(&out).unwrap().count(), 1);
            }
        }
        assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
        let out = here.path().join("out");
        fs::create_dir_all(out.join(PRIVATE).join("lock")).unwrap();
        assert!(open(&out).unwrap_err().contains("lock: a run keeps a file of this name"));
    }

    #[cfg(unix)]
    #[test]
    fn where_no_folder_can_be_made_is_named() {
        let here = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| here.path().join(name));
        fs::write(&file, "precious").unwrap();
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        for (out, place, problem) in [
            (&file, &file, "a folder is needed here, and this is none"),
            (&file.join("a/b"), &file, "a folder is needed here, and this is none"),
            (&link, &link, "this is a link that leads to no folder"),
            (&link.join("a"), &link, "this is a link that leads to no folder"),
        ] {
            assert_eq!(open(out).unwrap_err(), format!("{}: {problem}; {ELSEWHERE}", place.display()));
        }
        assert_eq!(fs::read_dir(here.path()).unwrap().count(), 2);
    }

    #[test]
    fn of_unfinished_files_only_those_of_a_run_are_removed() {
        let here = tempfile::tempdir().unwrap();
        let mut folder = open(here.path()).unwrap();
        folder.write(Path::new("results.json"), b"1").unwrap();
        drop(folder);
        let private = here.path().join(PRIVATE);
        let own = private.join(format!("{UNFINISHED}{}", blake3::hash(b"1").to_hex()));
        let others = [
            ".halfshade-notes".to_owned(),
            format!("{UNFINISHED}notes"),
            format!("{UNFINISHED}{}", blake3::hash(b"2").to_hex()),
            "journal.old".to_owned(),
        ];
        others.iter().for_each(|name| fs::write(private.join(name), "precious").unwrap());
        fs::write(&own, "cut off").unwrap();
        let mut folder = open(here.path()).unwrap();
        assert!(!own.exists());
        folder.write(Path::new("results.json"), b"1").unwrap();
        assert_eq!(fs::read_dir(&private).unwrap().count(), 2 + others.len());
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
        let others = ["notes.txt".to_owned(), "unfinished-notes".to_owned(), format!("notes-{}.bin", "0".repeat(64))];
        others.iter().for_each(|name| fs::write(truths.join(name), "precious").unwrap());
        folder.remove_truths();
        assert_eq!(fs::read_dir(&truths).unwrap().count(), others.len());
        others.iter().for_each(|name| fs::remove_file(truths.join(name)).unwrap());
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
