//! The rules of the house: who may depend on whom, and who may look at the clock.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Name of each of our crates and of those of ours that it depends on; tests and benchmarks may use more.
fn dependencies() -> BTreeMap<String, Vec<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("metadata is JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let of = |package: &serde_json::Value| {
        let ours = package["dependencies"].as_array().into_iter().flatten().filter(|d| d["kind"].is_null());
        ours.filter_map(|d| d["name"].as_str()).map(str::to_owned).collect::<Vec<_>>()
    };
    packages.iter().map(|package| (package["name"].as_str().expect("a name").to_owned(), of(package))).collect()
}

#[test]
fn dependencies_run_one_way() {
    let allowed: BTreeMap<&str, &[&str]> = BTreeMap::from([
        ("halfshade-sh", &[][..]),
        ("halfshade-scene", &[]),
        ("halfshade-truth", &["halfshade-scene"]),
        ("halfshade-strategy", &["halfshade-scene", "halfshade-truth"]),
        ("halfshade-strategies", &["halfshade-sh", "halfshade-scene", "halfshade-strategy"]),
        ("halfshade-gpu", &["halfshade-sh", "halfshade-scene", "halfshade-strategy", "halfshade-strategies"]),
        ("halfshade-harness", &["halfshade-scene", "halfshade-strategy", "halfshade-truth"]),
    ]);
    let found = dependencies();
    assert!(found.len() >= 8, "{:?}", found.keys());
    for (name, dependencies) in found {
        let Some(allowed) = allowed.get(name.as_str()) else { continue };
        for dependency in dependencies.iter().filter(|d| d.starts_with("halfshade")) {
            assert!(allowed.contains(&dependency.as_str()), "{name} must not depend on {dependency}");
        }
    }
}

#[test]
fn only_the_gpu_crate_imports_wgpu() {
    for (name, dependencies) in dependencies() {
        assert!(name == "halfshade-gpu" || !dependencies.iter().any(|d| d == "wgpu"), "{name} imports wgpu");
    }
}

/// Every Rust file below `folder`, with its text.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).expect("source is text");
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty(), "{} holds no source", folder.display());
    found
}

#[test]
fn only_the_harness_looks_at_the_clock() {
    let crates = root().join("crates");
    for (path, text) in sources(&crates) {
        let relative = path.strip_prefix(&crates).expect("below crates");
        let exempt = relative.starts_with("halfshade-harness")
            || relative.components().any(|part| matches!(part.as_os_str().to_str(), Some("benches" | "examples")));
        // Tests come last in a file; they may time themselves.
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        for clock in ["Instant::now", "SystemTime::now"] {
            assert!(exempt || !code.contains(clock), "{} looks at the clock", path.display());
        }
    }
}

#[test]
fn strategies_never_import_each_other() {
    let folder = root().join("crates/halfshade-strategies/src");
    let strategies: Vec<String> = std::fs::read_dir(&folder)
        .expect("the strategies")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_dir())
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
        .collect();
    assert!(strategies.len() >= 2, "{strategies:?}");
    for strategy in &strategies {
        for (path, text) in sources(&folder.join(strategy)) {
            for other in strategies.iter().filter(|other| *other != strategy) {
                let inside = [format!("crate::{other}"), format!("super::super::{other}")];
                // `use crate::{a, other}` names it within braces.
                let grouped = text.split("use crate::{").skip(1).any(|rest| {
                    let group = rest.split(';').next().unwrap_or("");
                    group.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == other)
                });
                let named = inside.iter().any(|name| text.contains(name.as_str()));
                assert!(!named && !grouped, "{} imports {other}", path.display());
            }
        }
    }
}

#[test]
fn the_harness_names_no_strategy() {
    for (path, text) in sources(&root().join("crates/halfshade-harness/src")) {
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for name in ["sh-exp", "sh_exp", "ray-traced", "ray_traced", "unshadowed\"", "shadow_field", "cosine_lobe"] {
            assert!(!code.contains(name), "{} names {name}", path.display());
        }
    }
}
