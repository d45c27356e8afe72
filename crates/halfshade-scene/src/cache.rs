//! A disk cache for baked data: what was computed once from the same content with the same parameters is read back.
//!
//! An entry is a file `KIND-KEY.bin`, KEY a BLAKE3 hash of everything the data depends on, format version included. It
//! holds a mark, the BLAKE3 hash of its payload, and the payload (postcard). Entries are written to a temporary file and
//! renamed, so that nobody ever reads half of one. A cache is a convenience: a damaged entry, or one that isn't of what
//! was asked for, is refused and computed anew, a folder that can't be written means no caching; all leave a note for the
//! user and none is an error.

use crate::SceneError;
use serde::{Serialize, de::DeserializeOwned};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// First bytes of every entry; the digit is the version of the layout.
const MARK: &[u8; 8] = b"HSCACHE1";
const HASH_BYTES: usize = 32;

/// Infix between the name of an entry and some random letters while it is written.
const UNFINISHED: &str = ".unfinished-";

/// The environment variable that moves the cache.
pub const FOLDER_VARIABLE: &str = "HALFSHADE_CACHE";

/// A folder of baked data, or no caching at all.
#[derive(Debug, Clone, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
}

/// Origin of cached data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CacheSource {
    /// Read from the cache.
    Read,
    /// Computed now.
    Computed,
}

/// Outcome of one request: where the data came from, and notes for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CacheOutcome {
    /// Where the data came from.
    pub source: CacheSource,
    /// Damaged entries, folders that can't be written: one sentence each.
    pub notes: Vec<String>,
}

/// The key of an entry: a hash over everything that its data depends on.
#[derive(Debug, Clone)]
pub struct CacheKey {
    kind: &'static str,
    hasher: blake3::Hasher,
}

impl CacheKey {
    /// The key of data of `kind` (a short file-name part) whose computation has `version`: raise it whenever the
    /// algorithm or the stored type changes.
    pub fn new(kind: &'static str, version: u32) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(kind.as_bytes()).update(&[0]).update(&version.to_le_bytes());
        Self { kind, hasher }
    }

    /// Adds bytes, prefixed by their length so that neighbouring parts can't run into each other.
    pub fn bytes(mut self, bytes: &[u8]) -> Self {
        self.hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
        self
    }

    /// Adds anything that serializes, by its exact bits.
    pub fn value(self, value: &impl Serialize) -> Self {
        match postcard::to_stdvec(value) {
            Ok(bytes) => self.bytes(&bytes),
            // No type of ours fails; one that did would still get a key, if a coarser one that is never shared.
            Err(error) => self.bytes(error.to_string().as_bytes()),
        }
    }

    /// The name of the entry's file.
    pub fn file_name(&self) -> String {
        format!("{}-{}.bin", self.kind, self.hasher.finalize().to_hex())
    }
}

impl Cache {
    /// The cache in `folder`; without one, in the folder that HALFSHADE_CACHE names; without that, in `halfshade` under
    /// the platform's cache folder. Nothing is created before the first entry is written.
    pub fn open(folder: Option<PathBuf>) -> Self {
        let from_environment =
            || std::env::var_os(FOLDER_VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
        let folder = folder.or_else(from_environment).or_else(|| Some(dirs::cache_dir()?.join("halfshade")));
        Self { folder }
    }

    /// No caching: everything is computed.
    pub const fn disabled() -> Self {
        Self { folder: None }
    }

    /// Folder of the entries, if anything is cached.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The data under `key`, read if there is a sound entry that `fits`, else computed by `compute` and stored. `fits`
    /// tells whether data have the lengths and ranges that their users rely on; a checksum doesn't.
    ///
    /// # Errors
    /// Those of `compute` only.
    pub fn get_or_compute<T: Serialize + DeserializeOwned>(
        &self,
        key: &CacheKey,
        fits: impl FnOnce(&T) -> bool,
        compute: impl FnOnce() -> Result<T, SceneError>,
    ) -> Result<(T, CacheOutcome), SceneError> {
        let Some(folder) = &self.folder else {
            return Ok((compute()?, CacheOutcome { source: CacheSource::Computed, notes: Vec::new() }));
        };
        let path = folder.join(key.file_name());
        let mut notes = Vec::new();
        match std::fs::read(&path) {
            Ok(bytes) => match decode(&bytes) {
                Ok(data) if !fits(&data) => {
                    notes.push(format!(
                        "refused the cache entry {}: it is of something else; computed anew",
                        path.display()
                    ));
                }
                Ok(data) => return Ok((data, CacheOutcome { source: CacheSource::Read, notes })),
                Err(problem) => {
                    notes.push(format!("refused the cache entry {}: {problem}; computed anew", path.display()));
                }
            },
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => notes.push(format!("could not read the cache entry {}: {error}", path.display())),
        }
        let data = compute()?;
        if let Err(problem) = encode(&data).and_then(|bytes| write_whole(folder, &path, &bytes)) {
            notes.push(format!("nothing was cached in {}: {problem}", folder.display()));
        }
        Ok((data, CacheOutcome { source: CacheSource::Computed, notes }))
    }
}

/// Whether the file at `path` is an entry of a cache, by its name and its first bytes, or what is left of one that was
/// never finished, by its name.
pub fn is_entry(path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
    let has_mark = || {
        let mut start = [0; MARK.len()];
        std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == *MARK
    };
    match name.split_once(UNFINISHED) {
        Some((whole, _)) => is_entry_name(whole),
        None => is_entry_name(name) && has_mark(),
    }
}

fn is_entry_name(name: &str) -> bool {
    let key = name.strip_suffix(".bin").and_then(|stem| stem.rsplit_once('-')).map(|(_, key)| key);
    key.is_some_and(|key| key.len() == 2 * HASH_BYTES && key.chars().all(|c| c.is_ascii_hexdigit()))
}

fn encode(data: &impl Serialize) -> Result<Vec<u8>, String> {
    let payload = postcard::to_stdvec(data).map_err(|error| error.to_string())?;
    Ok([MARK.as_slice(), blake3::hash(&payload).as_bytes(), &payload].concat())
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (mark, rest) = bytes.split_at_checked(MARK.len()).ok_or("it is too short")?;
    if mark != MARK {
        return Err("it is not a cache entry of this version".into());
    }
    let (hash, payload) = rest.split_at_checked(HASH_BYTES).ok_or("it is too short")?;
    if blake3::hash(payload).as_bytes() != hash {
        return Err("its checksum does not match, it is damaged".into());
    }
    postcard::from_bytes(payload).map_err(|error| error.to_string())
}

/// Writes beside the target and renames, so that the target is either whole or absent.
fn write_whole(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), String> {
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut file = tempfile::Builder::new().prefix(&format!("{name}{UNFINISHED}")).tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> CacheKey {
        CacheKey::new("test", 1).value(&(3.5f64, "parameters"))
    }

    fn ask(cache: &Cache, value: u32) -> (u32, CacheOutcome) {
        cache.get_or_compute(&key(), |_| true, || Ok(value)).unwrap()
    }

    fn only_entry(folder: &Path) -> PathBuf {
        let entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert_eq!(entries.len(), 1, "one entry and no temporary file: {entries:?}");
        entries[0].clone()
    }

    #[test]
    fn computes_once() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().join("new/below")));
        assert_eq!(ask(&cache, 7), (7, CacheOutcome { source: CacheSource::Computed, notes: vec![] }));
        assert_eq!(ask(&cache, 8), (7, CacheOutcome { source: CacheSource::Read, notes: vec![] }));
        assert_eq!(ask(&Cache::disabled(), 8).0, 8);
        let other = cache.get_or_compute(&key().bytes(b"more"), |_| true, || Ok(9u32)).unwrap();
        assert_eq!((other.0, other.1.source), (9, CacheSource::Computed));
    }

    #[test]
    fn every_single_damaged_byte_is_refused_and_repaired() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().into()));
        ask(&cache, 1);
        let path = only_entry(folder.path());
        let sound = std::fs::read(&path).unwrap();
        let mut broken: Vec<Vec<u8>> = (0..sound.len()).map(|n| sound[..n].to_vec()).collect();
        broken.extend((0..sound.len()).map(|n| {
            let mut bytes = sound.clone();
            bytes[n] ^= 0x10;
            bytes
        }));
        broken.push([sound.as_slice(), b"tail"].concat());
        for bytes in broken {
            std::fs::write(&path, bytes).unwrap();
            let (value, outcome) = ask(&cache, 1);
            assert_eq!((value, outcome.source, outcome.notes.len()), (1, CacheSource::Computed, 1));
            assert_eq!(std::fs::read(&path).unwrap(), sound);
        }
    }

    /// An entry whose checksum is sound, but whose content another program wrote.
    #[test]
    fn an_entry_of_something_else_is_refused_and_repaired() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().into()));
        ask(&cache, 1);
        let (value, outcome) = cache.get_or_compute(&key(), |found: &u32| *found == 2, || Ok(2)).unwrap();
        assert_eq!((value, outcome.source), (2, CacheSource::Computed));
        assert!(outcome.notes[0].contains("something else"), "{outcome:?}");
        assert_eq!(ask(&cache, 3).0, 2);
    }

    #[test]
    fn an_unwritable_folder_only_leaves_a_note() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a file, not a folder");
        std::fs::write(&file, "").unwrap();
        let (value, outcome) = ask(&Cache::open(Some(file.join("cache"))), 5);
        assert_eq!((value, outcome.source), (5, CacheSource::Computed));
        assert!(outcome.notes.iter().any(|note| note.contains("nothing was cached")), "{outcome:?}");
        assert_eq!(std::fs::read(&file).unwrap(), b"");
    }

    #[test]
    fn errors_are_not_cached() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().into()));
        assert!(cache.get_or_compute::<u32>(&key(), |_| true, || Err(SceneError::new("no"))).is_err());
        assert_eq!(ask(&cache, 2).0, 2);
    }

    #[test]
    fn parts_of_a_key_do_not_run_together() {
        let name = |key: CacheKey| key.file_name();
        assert_ne!(
            name(CacheKey::new("k", 1).bytes(b"ab").bytes(b"c")),
            name(CacheKey::new("k", 1).bytes(b"a").bytes(b"bc"))
        );
        assert_ne!(name(CacheKey::new("k", 1)), name(CacheKey::new("k", 2)));
        assert!(is_entry_name(&name(CacheKey::new("two-words", 1))) && !is_entry_name("truth-0.bin"));
        // An unfinished entry is recognized by its whole name.
        assert!(is_entry(Path::new(&(name(CacheKey::new("k", 1)) + ".unfinished-a1B2c3"))));
        assert!(!is_entry(Path::new("unfinished-notes")) && !is_entry(Path::new("notes.bin.unfinished-a1B2c3")));
        assert_ne!(name(CacheKey::new("k", 1).value(&0.0f32)), name(CacheKey::new("k", 1).value(&-0.0f32)));
    }
}
