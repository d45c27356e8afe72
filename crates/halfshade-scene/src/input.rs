//! Files that a scene is read from: whoever keeps a measurement keeps what it was made from.
//!
//! All reading of input goes through [`read`], which tells the content of each file to whoever asked for it with
//! [`recorded`]. What is hashed is what was read: a file that changes in between is told as it was used.

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
    /// What this thread has read since the innermost [`recorded`] began, if there is one.
    static READ: RefCell<Option<Vec<InputFile>>> = const { RefCell::new(None) };
}

/// The bytes of an input file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
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
