//! Random scenes at the extremes, and what every strategy must keep to on each of them.
//!
//! Scenes are drawn from a seed: scales from 1e-6 to 1e6, far from the origin, details of a hundred-thousandth, many
//! identical objects, objects that touch and contain each other, needles, sheets and degenerate triangles, light from
//! 1e-38 to 1e30, suns from 0.01 to 90 degrees, lamps from specks to ones around everything, gloss, bounces, movement.
//! Settings of strategies are drawn from the ranges that they declare. `properties.rs` says what is checked,
//! `tolerances.rs` how closely, and why.
//!
//! By default so many scenes are drawn that it takes about a minute on two cores. For hours of it, and to look at one again:
//!
//! ```text
//! HALFSHADE_EXTREMES_SCENES=20000 cargo test -p halfshade-tests --test extremes
//! HALFSHADE_EXTREMES_FIRST=1234 HALFSHADE_EXTREMES_SCENES=1 cargo test -p halfshade-tests --test extremes
//! ```
//!
//! A scene that fails is written as a scene file that `halfshade render` opens, and its seed becomes one of
//! `regressions.rs`.

mod lights;
mod parameters;
mod properties;
mod random;
mod receivers;
mod regressions;
mod ringing;
mod scene;
mod scene_file;
mod shapes;
mod tolerances;

use halfshade_scene::{Cache, file};
use halfshade_strategy::Strategy;
use parameters::Subject;
use properties::{Check, Failure};
use random::Random;
use rayon::prelude::*;
use scene::Drawn;
use std::{
    collections::BTreeMap,
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
};

/// About a minute on two cores.
const SCENES: u64 = 20;

/// Value of an environment variable, if it is a number.
fn asked(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

/// Result of one strategy on one scene.
struct Outcome {
    seed: u64,
    name: &'static str,
    spec: String,
    /// `None` where it says that it can't model the scene.
    failures: Option<Vec<Failure>>,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "seed {}, {}", self.seed, self.spec)?;
        let mut each = self.failures.iter().flatten();
        each.try_for_each(|failure| write!(f, "\n    {}: {}", failure.property, failure.message))
    }
}

/// Every strategy on the scene of a seed, with settings drawn by the same seed.
fn outcomes(strategies: &[Box<dyn Strategy>], seed: u64) -> Vec<Outcome> {
    let drawn = Drawn::new(seed);
    let settings = strategies.iter().enumerate().map(|(number, strategy)| {
        Subject::draw(strategy.as_ref(), &mut Random::new(seed ^ ((number as u64 + 1) << 48)))
    });
    settings.map(|subject| outcome(strategies, &drawn, &subject)).collect()
}

/// One of them. What is drawn on the way depends on the scene's seed alone.
fn outcome(strategies: &[Box<dyn Strategy>], drawn: &Drawn, subject: &Subject<'_>) -> Outcome {
    let unshadowed = strategies.iter().find(|strategy| strategy.info().name == "unshadowed").expect("a strategy");
    let unshadowed = Subject::parse(unshadowed.as_ref(), "");
    let check = Check { subject, unshadowed: &unshadowed, drawn };
    // A panic is a failure like others: its seed must be told too.
    let failures = catch_unwind(AssertUnwindSafe(|| check.run(&mut Random::new(drawn.seed))));
    let panicked = || vec![Failure { property: "no panic", message: "see above".into() }];
    let failures = failures.unwrap_or_else(|_| Some(panicked()));
    Outcome { seed: drawn.seed, name: subject.name, spec: subject.spec.clone(), failures }
}

/// Folder for scenes that fail.
fn folder_of(outcome: &Outcome) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("extreme-{}-{}", outcome.seed, outcome.name))
}

/// Fails with all that failed, after writing the scenes.
fn report(outcomes: &[Outcome]) {
    let failed: Vec<&Outcome> =
        outcomes.iter().filter(|outcome| outcome.failures.iter().flatten().count() > 0).collect();
    let mut text = String::new();
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for outcome in &failed {
        let folder = folder_of(outcome);
        let written = scene_file::write(&Drawn::new(outcome.seed), &folder, &outcome.to_string());
        let place =
            written.map_or_else(|error| error.to_string(), |()| folder.join("scene.toml").display().to_string());
        text += &format!("{outcome}\n    {place}\n");
        for failure in outcome.failures.iter().flatten() {
            *counts.entry((outcome.name, failure.property)).or_default() += 1;
        }
    }
    let summary: String = counts.iter().map(|((name, what), count)| format!("{name}: {what}: {count}\n")).collect();
    assert!(failed.is_empty(), "{text}{summary}");
}

#[test]
fn random_extreme_scenes() {
    let strategies = halfshade::strategies(&Cache::disabled());
    let first = asked("HALFSHADE_EXTREMES_FIRST").unwrap_or(0);
    let count = asked("HALFSHADE_EXTREMES_SCENES").unwrap_or(SCENES);
    let all: Vec<Outcome> =
        (first..first + count).into_par_iter().flat_map_iter(|seed| outcomes(&strategies, seed)).collect();
    for strategy in &strategies {
        let name = strategy.info().name;
        let modelled = all.iter().filter(|outcome| outcome.name == name && outcome.failures.is_some()).count();
        // A test that refuses everything would prove nothing.
        assert!(count < 20 || 4 * modelled as u64 > count, "{name} took {modelled} of {count} scenes");
    }
    report(&all);
}

#[test]
fn scenes_that_failed_once() {
    let strategies = halfshade::strategies(&Cache::disabled());
    let all: Vec<Outcome> = (regressions::ALL.par_iter())
        .map(|&(seed, spec, _)| {
            let (name, settings) = spec.split_once(':').expect("a strategy and its settings");
            let strategy = strategies.iter().find(|strategy| strategy.info().name == name).expect("a known strategy");
            let subject = Subject::parse(strategy.as_ref(), settings);
            outcome(&strategies, &Drawn::new(seed), &subject)
        })
        .collect();
    report(&all);
}

#[test]
fn the_same_seed_draws_the_same_and_the_program_opens_what_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for seed in 0..30 {
        let drawn = Drawn::new(seed);
        let [a, b] = [&drawn, &Drawn::new(seed)].map(|drawn| format!("{:?}", drawn.scene));
        assert_eq!(a, b);
        let folder = folder.path().join(seed.to_string());
        scene_file::write(&drawn, &folder, "a comment\nof two lines").expect("a scene can be written");
        let meshes = drawn.scene.objects.iter().filter(|object| !object.mesh.triangles.is_empty()).count();
        match file::load(&folder.join("scene.toml")) {
            Ok(scene) => assert_eq!((scene.objects.len(), scene.bounces), (meshes, drawn.scene.bounces)),
            Err(error) => assert_eq!(meshes, 0, "seed {seed}: {error}"),
        }
    }
}
