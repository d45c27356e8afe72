//! The experiments that come with the repository: each says what it claims, and names only what there is.

use halfshade_harness::{Experiment, variant};
use std::path::Path;

#[test]
fn every_experiment_of_the_repository_can_be_planned() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("experiments") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let experiment = Experiment::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Some(experiment.name.as_str()), path.file_stem().and_then(|stem| stem.to_str()));
        assert!(experiment.claim.len() > 20, "{}: say which claim it tests", path.display());
        let variants = variant::sweep(&experiment, &halfshade::strategies(&halfshade_scene::Cache::disabled()))
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(!variants.is_empty());
        count += 1;
    }
    assert!(count >= 3);
}
