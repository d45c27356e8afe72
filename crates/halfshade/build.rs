//! Tells the program which commit it was built from, where git can say.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // `.git/HEAD` only names the branch: a commit moves the log.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    let commit = git(&["describe", "--always", "--dirty", "--exclude", "*"]);
    println!("cargo::rustc-env=HALFSHADE_COMMIT={}", commit.unwrap_or_default());
}

/// Git's answer without the line's end; `None` where there is no git or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
