//! Runs that are interrupted, resumed, repeated, or given folders and inputs that are not what they were: nothing is
//! lost, and nothing is mixed.

mod devices;
mod folders;
mod inputs;
mod interruptions;
#[cfg(unix)]
mod parts;
mod refusals;

use crate::common::{folder, write};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

pub(crate) const SCENE: &str = "name = \"corner\"\n[[object]]\nmesh = \"tetrahedron.obj\"\nspheres = 2\n\
                     [[object]]\nshape = \"plane\"\nscale = 3\n\
                     [camera]\neye = [0, 2, 5]\ntarget = [0, 0.5, 0]\nresolution = [24, 16]\n";

pub(crate) const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

pub(crate) const EXPERIMENT: &str = r#"
name = "small"
claim = "none"
receivers = ["vertices", "pixels"]
[truth]
samples = 64
[timing]
warm_up = 1
repeats = 3
[pictures]
[[scene]]
name = "scene.toml"
[[strategy]]
name = "unshadowed"
[[strategy]]
name = "ray-traced"
samples = [1, 4]
"#;

/// A folder with the experiment and all that it reads.
pub(crate) fn prepared() -> tempfile::TempDir {
    let here = folder();
    write(here.path(), "small.toml", EXPERIMENT);
    write(here.path(), "scene.toml", SCENE);
    write(here.path(), "tetrahedron.obj", MESH);
    here
}

pub(crate) fn start(here: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_halfshade-under-test"))
        .current_dir(here)
        .env("HALFSHADE_CACHE", here.join("cache"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started")
}

/// Starts the experiment and waits until its journal has so many lines; fails if the run ends before.
pub(crate) fn started(here: &Path, lines: usize) -> Child {
    let mut child = start(here, &["run", "small.toml"]);
    let journal = here.join("out/small/.halfshade/journal.jsonl");
    while fs::read(&journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count()) < lines {
        assert!(child.try_wait().expect("a status").is_none(), "the run ended too early");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// An experiment that takes long enough to be interrupted.
pub(crate) fn long(here: &Path) {
    write(here, "small.toml", EXPERIMENT.replace("repeats = 3", "repeats = 10000"));
}

pub(crate) fn results(here: &Path) -> Value {
    serde_json::from_slice(&fs::read(here.join("out/small/results.json")).expect("results")).expect("JSON")
}

/// All that isn't time: the text of what every run was found to be, and the bytes of every picture.
pub(crate) fn found(here: &Path) -> (Vec<String>, BTreeMap<PathBuf, Vec<u8>>) {
    let results = results(here);
    let of_run = |run: &Value| format!("{} {} {} {}", run["label"], run["receivers"], run["error"], run["truth"]);
    let runs = results["runs"].as_array().expect("runs").iter().map(of_run).collect();
    let tree = tree(&here.join("out/small/pictures"));
    (runs, tree.into_iter().filter_map(|(path, bytes)| Some((path, bytes?))).collect())
}

/// Everything below a folder: files with their bytes, links with where they lead, folders.
pub(crate) fn tree(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut tree = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry").path();
        if path.is_symlink() {
            let target = fs::read_link(&path).expect("a link");
            tree.insert(path, Some(target.to_string_lossy().into_owned().into_bytes()));
        } else if path.is_dir() {
            tree.extend(self::tree(&path));
            tree.insert(path, None);
        } else {
            let bytes = fs::read(&path).expect("read");
            tree.insert(path, Some(bytes));
        }
    }
    tree
}

/// Fails if anything that was there before is gone or has changed.
pub(crate) fn assert_kept(before: &BTreeMap<PathBuf, Option<Vec<u8>>>, folder: &Path) {
    let after = tree(folder);
    for (path, content) in before {
        assert_eq!(after.get(path), Some(content), "{}", path.display());
    }
}
