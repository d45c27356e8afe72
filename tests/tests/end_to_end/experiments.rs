//! The experiments that come with the repository: each says what it claims, and names only what there is.

use halfshade_harness::{
    Experiment,
    run::{Plan, RunOptions},
};
use std::path::{Path, PathBuf};

/// Scenes are loaded and every name is looked up; nothing is baked. Most of the time goes into making built-in scenes,
/// for which experiments needn't wait for each other.
#[test]
fn every_experiment_of_the_repository_can_be_planned() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments");
    let entries = std::fs::read_dir(&folder).expect("experiments").map(|entry| entry.expect("an entry").path());
    let paths: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    assert!(paths.len() >= 3);
    paths.iter().for_each(|path| check(path));
}

fn check(path: &Path) {
    let experiment = Experiment::load(path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(Some(experiment.name.as_str()), path.file_stem().and_then(|stem| stem.to_str()));
    assert!(experiment.claim.len() > 20, "{}: say which claim it tests", path.display());
    let strategies = halfshade::strategies(&halfshade_scene::Cache::disabled());
    let plan = Plan::new(&experiment, &strategies, &RunOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let swept = experiment.scenes.iter().map(|entry| entry.swept(&experiment).expect("a sweep").len());
    assert_eq!(plan.scenes.len(), swept.sum::<usize>(), "{}", path.display());
    assert!(plan.scenes.iter().all(|planned| !planned.frames.is_empty()) && !plan.variants.is_empty());
}
