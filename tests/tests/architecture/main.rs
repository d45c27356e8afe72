//! The rules of the house: who may depend on whom, and who may look at the clock.

mod circles;

use circles::{Sources, circles};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Our crates, as cargo knows them.
fn packages() -> Vec<serde_json::Value> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("metadata is JSON");
    metadata["packages"].as_array().expect("packages").clone()
}

/// Name of each of our crates and of what it is made of; tests and benchmarks may use more.
fn dependencies() -> BTreeMap<String, Vec<String>> {
    let of = |package: &serde_json::Value| {
        let needed = package["dependencies"].as_array().into_iter().flatten().filter(|d| d["kind"] != "dev");
        needed.filter_map(|d| d["name"].as_str()).map(str::to_owned).collect::<Vec<_>>()
    };
    packages().iter().map(|package| (package["name"].as_str().expect("a name").to_owned(), of(package))).collect()
}

/// Facts that a registry asks for, of all that isn't for tests alone.
#[test]
fn every_crate_says_what_it_is() {
    for package in packages().iter().filter(|package| package["name"] != "halfshade-tests") {
        for key in ["description", "license"] {
            assert!(package[key].as_str().is_some_and(|text| !text.is_empty()), "{}: {key}", package["name"]);
        }
        for key in ["keywords", "categories"] {
            let words = package[key].as_array().expect("a list");
            assert!((1..=5).contains(&words.len()), "{}: {key}", package["name"]);
        }
        let manifest = Path::new(package["manifest_path"].as_str().expect("a path"));
        let front = std::fs::read_to_string(manifest.with_file_name("src").join("lib.rs")).expect("a library");
        let mut docs = front.lines().take_while(|line| line.starts_with("//!"));
        let is_code = |line: &str| line == "//! ```no_run" || line.starts_with("//! assert");
        assert!(docs.any(is_code), "{}: no example that is compiled on its front page", package["name"]);
    }
}

/// Dependencies that each of our crates may have, as ARCHITECTURE.md draws them: lines such as `truth ← scene`.
fn drawn() -> BTreeMap<String, Vec<String>> {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let plan = text.split("Dependencies run one way").nth(1).and_then(|rest| rest.split("```").nth(1)).expect("a plan");
    let full = |name: &str| match name {
        "halfshade" => name.to_owned(),
        part => format!("halfshade-{part}"),
    };
    let lines = plan.lines().filter(|line| !line.trim().is_empty());
    let line = |line: &str| {
        let (name, parts) = line.split_once('←').unwrap_or((line, ""));
        (full(name.trim()), parts.split_whitespace().map(full).collect())
    };
    lines.map(line).collect()
}

#[test]
fn dependencies_are_those_that_the_plan_draws() {
    let (found, drawn) = (dependencies(), drawn());
    assert!(found.len() >= 8, "{:?}", found.keys());
    for (name, dependencies) in found {
        let allowed = drawn.get(&name).unwrap_or_else(|| panic!("ARCHITECTURE.md draws no {name}"));
        for dependency in dependencies.iter().filter(|d| d.starts_with("halfshade")) {
            assert!(
                allowed.contains(dependency),
                "{name} must not depend on {dependency}: ARCHITECTURE.md doesn't draw it"
            );
        }
    }
}

/// Whatever else the plan may come to draw.
#[test]
fn the_plan_draws_nothing_that_would_share_a_mistake_with_the_truth_or_favour_a_strategy() {
    let drawn = drawn();
    let forbidden = [
        ("truth", &["sh", "strategy", "strategies"][..]),
        ("strategy", &["truth"]),
        ("strategies", &["truth"]),
        ("harness", &["sh", "strategies"]),
    ];
    for (name, others) in forbidden {
        let parts = &drawn[&format!("halfshade-{name}")];
        for other in others {
            assert!(!parts.contains(&format!("halfshade-{other}")), "ARCHITECTURE.md draws {name} ← {other}");
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
fn no_two_files_of_a_crate_use_each_other_in_a_circle() {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(root().join("crates")).expect("the crates") {
        let folder = entry.expect("an entry").path().join("src");
        let below = |(path, text): (PathBuf, String)| (path.strip_prefix(&folder).expect("below src").to_owned(), text);
        let files: Sources = sources(&folder).into_iter().map(below).collect();
        for circle in circles(&files) {
            let files: Vec<String> = circle.files.iter().map(|file| file.display().to_string()).collect();
            let place = folder.parent().and_then(Path::file_name).unwrap_or_default().display();
            found.push(format!("{place}: {}\n    {}", files.join(", "), circle.uses.join("\n    ")));
        }
    }
    assert!(found.is_empty(), "{} circles:\n{}", found.len(), found.join("\n"));
}

/// Packages that list their tests (`autotests = false`) leave out others without a word.
#[test]
fn no_file_of_tests_is_left_out() {
    for entry in std::fs::read_dir(root().join("crates")).expect("the crates") {
        let package = entry.expect("an entry").path();
        let tests = package.join("tests");
        if !tests.is_dir() {
            continue;
        }
        let manifest = std::fs::read_to_string(package.join("Cargo.toml")).expect("a manifest");
        let found = std::fs::read_dir(&tests).expect("tests").map(|entry| entry.expect("an entry").path());
        let is_rust = |path: &PathBuf| {
            path.extension().is_some_and(|ending| ending == "rs")
                || path.join("mod.rs").exists()
                || path.join("main.rs").exists()
        };
        if !found.into_iter().any(|path| is_rust(&path)) {
            continue;
        }
        for (path, _) in sources(&tests) {
            let relative = path.strip_prefix(&package).expect("below the package");
            let is_listed = manifest.contains(&format!("path = \"{}\"", relative.display()));
            let is_discovered = !manifest.contains("autotests = false")
                && (path.parent() == Some(&tests) || path.file_name().is_some_and(|name| name == "main.rs"));
            assert!(is_listed || is_discovered || is_module(&path), "no test program has {}", relative.display());
        }
    }
}

/// Whether a file in the folder of `path`, or above it for a folder's `mod.rs`, declares it as a module.
fn is_module(path: &Path) -> bool {
    let is_folder = path.file_name().is_some_and(|name| name == "mod.rs");
    let module = if is_folder { path.parent().unwrap_or(path) } else { path };
    let (Some(name), Some(folder)) = (module.file_stem().and_then(|stem| stem.to_str()), module.parent()) else {
        return false;
    };
    let declares = |file: &str| {
        let text = std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        text.lines().any(|line| line.trim_start_matches("pub(crate) ") == format!("mod {name};"))
    };
    declares("main.rs") || declares("mod.rs")
}

#[test]
fn only_the_harness_looks_at_the_clock() {
    let crates = root().join("crates");
    for (path, text) in sources(&crates) {
        let relative = path.strip_prefix(&crates).expect("below crates");
        let exempt = relative.starts_with("halfshade-harness")
            || relative
                .components()
                .any(|part| matches!(part.as_os_str().to_str(), Some("benches" | "examples" | "tests")));
        // Tests, which come last in a file or have files of their own, may time themselves.
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        for clock in ["Instant::now", "SystemTime::now"] {
            assert!(exempt || !code.contains(clock), "{} looks at the clock", path.display());
        }
    }
}

#[test]
fn every_input_is_read_where_it_is_recorded() {
    let scene = root().join("crates/halfshade-scene/src");
    for (path, text) in sources(&scene) {
        let relative = path.strip_prefix(&scene).expect("below the crate");
        // Entries of a cache were computed from input that is recorded.
        let exempt = relative == Path::new("input.rs") || relative == Path::new("cache.rs");
        let is_test = path.file_stem().is_some_and(|stem| stem == "tests");
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        for reading in ["fs::read", "File::open", "OpenOptions", "import_buffers", "image::open"] {
            let what = format!("{} reads a file past `input::read`: {reading}", path.display());
            assert!(exempt || is_test || !code.contains(reading), "{what}");
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
            // `shared` may be imported by all strategies, and imports none of them.
            for other in strategies.iter().filter(|other| *other != strategy && *other != "shared") {
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

/// The keys of `[Key2006]` and `[Key2006, section]` in a text: letters from a capital on, then a year.
fn cited(text: &str) -> impl Iterator<Item = &str> {
    text.split('[').skip(1).filter_map(|rest| {
        let key = &rest[..rest.find(|c: char| !c.is_ascii_alphanumeric())?];
        let name = key.trim_end_matches(|c: char| c.is_ascii_digit());
        let capital = name.starts_with(|c: char| c.is_ascii_uppercase());
        let words = name.len() > 1 && name.bytes().all(|c| c.is_ascii_alphabetic());
        (capital && words && key.len() == name.len() + 4).then_some(key)
    })
}

#[test]
fn every_citation_is_in_the_bibliography() {
    assert_eq!(cited("a[Abc2006, 4.1], [x1999] \\[De1998\\] [F32x2]").collect::<Vec<_>>(), ["Abc2006", "De1998"]);
    let bibliography = std::fs::read_to_string(root().join("references.bib")).expect("references.bib");
    let known: Vec<&str> = bibliography
        .lines()
        .filter(|line| line.starts_with('@'))
        .filter_map(|line| line.split_once('{')?.1.strip_suffix(','))
        .collect();
    let mut count = 0;
    for (path, text) in sources(&root().join("crates")) {
        for key in cited(&text) {
            assert!(known.contains(&key), "{} cites [{key}], which references.bib lacks", path.display());
            count += 1;
        }
    }
    assert!(count > 50, "{count} citations found");
}
