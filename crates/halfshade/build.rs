//! Tells the program which commit it was built from, where git can say.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../../.git/HEAD");
    let described = Command::new("git").args(["describe", "--always", "--dirty", "--exclude", "*"]).output();
    let commit = described
        .ok()
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok());
    println!("cargo::rustc-env=HALFSHADE_COMMIT={}", commit.unwrap_or_default().trim());
}
