#![no_main]
//! Experiment files, up to the plan of what is to be done. Scenes that are built in are left out: building one takes
//! longer than a thousand inputs.

use halfshade_fuzz::{beside, file};
use halfshade_harness::{
    Experiment,
    run::{Plan, RunOptions},
};
use halfshade_scene::{Cache, builtin};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    beside();
    let Ok(experiment) = Experiment::load(&file("e.toml", bytes)) else { return };
    let built_in = |name: &str| builtin::SCENES.iter().any(|(known, _)| *known == name);
    if experiment.scenes.iter().any(|scene| built_in(scene.name.get_ref())) {
        return;
    }
    let strategies = halfshade::strategies(&Cache::disabled());
    for quick in [false, true] {
        let _ = Plan::new(&experiment, &strategies, &RunOptions { quick, ..RunOptions::default() });
    }
});
