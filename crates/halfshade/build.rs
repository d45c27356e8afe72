//! Tells the program its version, with the commit that it was built from where git can say.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // `.git/HEAD` only names the branch: a commit moves the log.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    let commit = git(&["describe", "--always", "--dirty", "--exclude", "*"]);
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let revision = commit.map_or(version.clone(), |commit| format!("{version} ({commit})"));
    println!("cargo::rustc-env=HALFSHADE_REVISION={revision}");
}

/// Git's answer without the line's end; `None` where there is no git or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
