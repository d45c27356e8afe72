//! Files that an experiment is made from, by content: what was measured from one may not stand beside what was measured
//! from another.

use halfshade_scene::InputFile;
use std::path::{Path, PathBuf};

/// The same files with paths as seen from `folder`, wherever they lie in it or are named relative to it.
pub fn relative_to(folder: &Path, files: Vec<InputFile>) -> Vec<InputFile> {
    let relative = |path: PathBuf| {
        let path = path.strip_prefix(folder).unwrap_or(&path);
        // The same on every system.
        let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
        if path.has_root() { path.to_owned() } else { PathBuf::from(parts.join("/")) }
    };
    let mut files: Vec<_> = files.into_iter().map(|file| InputFile { path: relative(file.path), ..file }).collect();
    files.sort();
    files.dedup();
    files
}

/// Differences between the inputs of two runs, for people; empty if they are the same.
pub fn changes(before: &[InputFile], now: &[InputFile]) -> Vec<String> {
    let has = |files: &[InputFile], path: &Path| files.iter().any(|file| file.path == path);
    let mut changes = Vec::new();
    for file in before.iter().filter(|file| !now.contains(file)) {
        let what = if has(now, &file.path) { "has changed" } else { "is no longer read" };
        changes.push(format!("`{}` {what}", file.path.display()));
    }
    for file in now.iter().filter(|file| !has(before, &file.path)) {
        changes.push(format!("`{}` was not read then", file.path.display()));
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, blake3: &str) -> InputFile {
        InputFile { path: path.into(), blake3: blake3.into() }
    }

    #[test]
    fn paths_are_those_that_the_experiment_says() {
        let read = ["e/a.toml", "e/../m/b.obj", "/c.hdr", "e/a.toml"].map(|path| file(path, "0"));
        let found = relative_to(Path::new("e"), read.to_vec());
        assert_eq!(found, ["/c.hdr", "../m/b.obj", "a.toml"].map(|path| file(path, "0")));
    }

    #[test]
    fn every_change_is_named_once() {
        let before = [file("a", "0"), file("b", "0"), file("c", "0")];
        let now = [file("a", "0"), file("b", "1"), file("d", "0")];
        let expected = ["`b` has changed", "`c` is no longer read", "`d` was not read then"];
        assert_eq!(changes(&before, &now), expected);
        assert!(changes(&before, &before).is_empty());
    }
}
