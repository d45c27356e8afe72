//! The results of several parts as one.

use super::loaded::Loaded;
use crate::{
    HarnessError, Results,
    results::{Machine, Run, Status},
};
use std::collections::HashMap;

/// Runs of `errors` one after the other, with the times of `times`.
pub(super) fn join(errors: &[&Loaded], times: Option<&Loaded>) -> Result<Results, HarnessError> {
    let mut joined = Results { part: None, scenes: Vec::new(), runs: Vec::new(), ..errors[0].results.clone() };
    (joined.differences, joined.pictures) = (Vec::new(), Vec::new());
    for part in errors {
        let Results { scenes, runs, differences, pictures, .. } = part.results.clone();
        // A scene may be shared by neighbours.
        let is_new = |name: &str| joined.scenes.last().is_none_or(|last| last.name != name);
        joined.scenes.extend(scenes.into_iter().filter(|scene| is_new(&scene.name)).collect::<Vec<_>>());
        joined.runs.extend(runs);
        joined.differences.extend(differences);
        joined.pictures.extend(pictures);
    }
    // Baking was timed where others may have been at work.
    joined.runs.iter_mut().for_each(|run| run.time = None);
    joined.machine = machine(errors);
    if let Some(times) = times {
        add_times(&mut joined.runs, times)?;
        joined.machine = times.results.machine.clone();
    }
    Ok(joined)
}

/// Gives every run its time.
fn add_times(runs: &mut [Run], times: &Loaded) -> Result<(), HarnessError> {
    let timed: HashMap<String, &Run> = times.results.runs.iter().map(|run| (run.key(), run)).collect();
    for run in runs.iter_mut().filter(|run| run.status == Status::Ok && !run.is_reference()) {
        let Some(with_time) = timed.get(&run.key()) else {
            let problem = format!("has no time of {}, which the other parts have", run.place());
            return Err(HarnessError::in_file(&times.folder, problem));
        };
        run.time.clone_from(&with_time.time);
    }
    Ok(())
}

/// The machine, or all of them.
fn machine(parts: &[&Loaded]) -> Machine {
    let mut machines: Vec<&Machine> = Vec::new();
    for machine in parts.iter().map(|part| &part.results.machine) {
        if !machines.contains(&machine) {
            machines.push(machine);
        }
    }
    let names = |name: fn(&Machine) -> Option<&str>| {
        let mut names: Vec<&str> = machines.iter().filter_map(|machine| name(machine)).collect();
        names.dedup();
        (!names.is_empty()).then(|| names.join("; "))
    };
    Machine {
        cpu: names(|machine| Some(&machine.cpu)).unwrap_or_default(),
        threads: machines.iter().map(|machine| machine.threads).max().unwrap_or(0),
        gpu: names(|machine| machine.gpu.as_deref()),
        os: names(|machine| Some(&machine.os)).unwrap_or_default(),
    }
}
