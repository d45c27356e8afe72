//! Common parts of the tests.

use assert_cmd::Command;
use std::{path::Path, sync::LazyLock};
use tempfile::TempDir;

/// One cache for a test program: sphere sets are built once.
static CACHE: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a temporary folder"));

/// The command, with a cache of its own, working in `folder`.
pub(crate) fn halfshade(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_halfshade-under-test"));
    command.current_dir(folder).env("HALFSHADE_CACHE", CACHE.path()).env("NO_COLOR", "1");
    command
}

/// A temporary folder.
pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a file and the folders that it lies in.
pub(crate) fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    std::fs::write(path, content).expect("written");
}

/// Standard output of a command that must succeed.
pub(crate) fn stdout(command: &mut Command) -> String {
    let output = command.assert().success().get_output().clone();
    String::from_utf8(output.stdout).expect("text")
}

/// Standard error of a command that must end with status 2, say `error: ..`, and not panic.
pub(crate) fn refused(command: &mut Command) -> String {
    let output = command.assert().code(2).get_output().clone();
    let text = String::from_utf8(output.stderr).expect("text");
    assert!(text.contains("error: ") && !text.contains("panicked"), "{text}");
    text
}

/// Tells whoever reads the test's output that it tested nothing.
#[expect(clippy::print_stderr, reason = "tests have no other way to say so")]
pub(crate) fn skipped(why: &str) {
    eprintln!("skipped: {why}");
}

/// Names in a folder, in order.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
