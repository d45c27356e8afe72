//! Files that a scene is read from: whoever keeps a measurement keeps what it was made from.
//!
//! All reading of input goes through [`read`], which tells the content of each file to whoever asked for it with
//! [`recorded`]. The bytes that were read are hashed: a file that changes in between is told as it was used.

use serde::{Deserialize, Serialize};
use std::{
    cell::RefCell,
    io,
    path::{Path, PathBuf},
};

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path, as it was opened.
    pub path: PathBuf,
    /// BLAKE3 hash of its bytes, in hexadecimal digits.
    pub blake3: String,
}

thread_local! {
    /// Files that this thread has read since the innermost [`recorded`] began, if there is one.
    static READ: RefCell<Option<Vec<InputFile>>> = const { RefCell::new(None) };
}

/// Most bytes of an input file: 8 GiB. All of it is held in memory.
const MOST_BYTES: u64 = 1 << 33;

/// The bytes of an input file. Pipes and devices, which may never end, are refused, and what is larger than 8 GiB.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        let found =
            if metadata.is_dir() { "it is a folder" } else { "it is a pipe or a device; copy what it holds to a file" };
        return Err(io::Error::other(found));
    }
    if metadata.len() > MOST_BYTES {
        return Err(io::Error::other(format!("it has {} bytes, and at most {MOST_BYTES} are read", metadata.len())));
    }
    let bytes = std::fs::read(path)?;
    record(path, &bytes);
    Ok(bytes)
}

/// Tells that `bytes` were read from `path`, for readers that open files themselves.
pub fn record(path: &Path, bytes: &[u8]) {
    READ.with_borrow_mut(|files| {
        if let Some(files) = files {
            files.push(InputFile { path: path.to_owned(), blake3: blake3::hash(bytes).to_hex().to_string() });
        }
    });
}

/// Does `work` and returns also which files it read on this thread, each once, by path.
pub fn recorded<T>(work: impl FnOnce() -> T) -> (T, Vec<InputFile>) {
    let outer = READ.replace(Some(Vec::new()));
    let result = work();
    let mut files = READ.replace(outer).unwrap_or_default();
    files.sort();
    files.dedup();
    (result, files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_and_what_is_too_large_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let problem = |path: &Path| read(path).unwrap_err().to_string();
        assert_eq!(problem(folder.path()), "it is a folder");
        let large = folder.path().join("large");
        std::fs::File::create(&large).unwrap().set_len(MOST_BYTES + 1).unwrap();
        assert_eq!(problem(&large), "it has 8589934593 bytes, and at most 8589934592 are read");
    }

    #[cfg(unix)]
    #[test]
    fn what_never_ends_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("endless");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        assert!(read(&link).unwrap_err().to_string().contains("pipe or a device"));
    }

    #[test]
    fn what_is_read_is_told_to_the_innermost_who_asks() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        std::fs::write(&a, "abc").unwrap();
        std::fs::write(&b, "").unwrap();
        let ((text, inner), outer) = recorded(|| {
            read(&b).unwrap();
            let inner = recorded(|| read(&a).unwrap());
            assert!(read(&folder.path().join("none")).is_err());
            read(&b).unwrap();
            inner
        });
        // The hash of "abc" that the authors of BLAKE3 publish.
        let abc = "6437b3ac38465133ffb63b75273a8db548c558465d79db03fd359c6cd5bd9d85";
        assert_eq!((&text[..], &inner[..]), (&b"abc"[..], &[InputFile { path: a.clone(), blake3: abc.into() }][..]));
        assert_eq!(outer.iter().map(|file| &file.path).collect::<Vec<_>>(), [&b]);
        read(&a).unwrap();
        assert_eq!(recorded(|| ()).1, []);
    }
}
