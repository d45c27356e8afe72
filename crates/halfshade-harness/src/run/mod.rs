//! Running an experiment: bake, prepare, shade, score, time, picture; journal every step.

mod choice;
mod difference;
mod group;
mod measure;
mod picture;
mod plan;
mod record;
mod references;
mod resume;
mod scenes;
mod score;
mod setup;
mod shade;
mod stages;
mod steps;
mod time;
mod tools;

pub use plan::Plan;
pub use scenes::PlannedScene;
pub use tools::{RunOptions, Tools};

use crate::{
    Experiment, HarnessError, Part, Results, inputs,
    journal::Header,
    machine,
    results::{PartFacts, SCHEMA, SceneFacts},
    threads,
};
use group::Group;
use halfshade_scene::Scene;
use measure::measure;
use record::Record;
use resume::{RunStart, header_of};
use setup::Setup;
use std::collections::BTreeMap;
use steps::Steps;

/// Runs `experiment` and returns its results; with [`RunOptions::out`], `results.json` and its company lie there.
pub fn run(experiment: &Experiment, tools: &Tools<'_>, options: &RunOptions) -> Result<Results, HarnessError> {
    let plan = Plan::new(experiment, tools.strategies, options)?;
    if plan.uses_graphics() && tools.graphics.is_none() {
        let problem = "this asks for device `gpu`, and there is none; name device `cpu` alone";
        return Err(HarnessError::in_file(&experiment.path, problem));
    }
    check_inputs(experiment, &plan, options)?;
    let timing_threads = plan.timing.and_then(|timing| timing.threads).map(|threads| threads.get());
    let threads = options.threads.or(timing_threads).unwrap_or_else(threads::available);
    let mut results = unmeasured(experiment, &plan, tools, options, threads);
    let header = Header { program: machine::program_hash(), ..header_of(&results) };
    let mut record = match &options.out {
        None => Record::default(),
        Some(out) => match RunStart::of(out, &plan.outputs(), &header, options.resume, tools.progress)? {
            RunStart::Finished(results) => return Ok(*results),
            RunStart::Open(record) => *record,
        },
    };
    let (steps, truth_cache) = (Steps::of(&plan, tools.progress), record.truth_cache());
    let setup = Setup { tools, plan: &plan, threads, steps, truth_cache, is_kept: record.is_kept() };
    threads::with_threads(Some(threads), || {
        let groups = plan.groups();
        for groups in groups.chunk_by(|a, b| a.scene == b.scene) {
            let place = groups[0].scene;
            let scene = with_spheres(&setup, &plan.scenes[place].scene)?;
            results.scenes.push(SceneFacts {
                name: scene.name.clone(),
                vertices: scene.vertex_count(),
                triangles: scene.objects.iter().map(|object| object.mesh.triangles.len()).sum(),
                spheres: scene.built_sphere_count(),
                published: plan.scenes[place].published.clone(),
            });
            for planned in groups {
                let group = Group::new(&setup, &scene, planned.clone())?;
                setup.steps.add(1);
                measure(&setup, &group, &mut record, &mut results)?;
            }
        }
        Ok::<(), HarnessError>(())
    })??;
    record.seal(&mut results)?;
    record.finish(&results)?;
    Ok(results)
}

/// Refuses scenes that are read from other files than a baseline was made from.
fn check_inputs(experiment: &Experiment, plan: &Plan, options: &RunOptions) -> Result<(), HarnessError> {
    let changes = options.inputs.as_ref().map(|expected| inputs::changes(expected, &plan.inputs)).unwrap_or_default();
    if changes.is_empty() {
        return Ok(());
    }
    let problem = format!(
        "the baseline was made from other files, so that errors can't be compared: {}; make it again",
        changes.join(", ")
    );
    Err(HarnessError::in_file(&experiment.path, problem))
}

/// Results of which nothing is measured yet.
fn unmeasured(
    experiment: &Experiment,
    plan: &Plan,
    tools: &Tools<'_>,
    options: &RunOptions,
    threads: usize,
) -> Results {
    Results {
        schema: SCHEMA.into(),
        experiment: experiment.name.clone(),
        claim: experiment.claim.clone(),
        experiment_hash: experiment.hash(),
        quick: options.quick,
        inputs: Some(plan.inputs.clone()),
        part: part_facts(plan),
        revision: tools.revision.to_owned(),
        machine: machine::describe(threads, tools.graphics.filter(|_| plan.uses_graphics())),
        strategies: tools.strategies.iter().map(|strategy| strategy.info().name.to_owned()).collect(),
        baseline: plan.baseline.map(|place| plan.variants[place].label.clone()),
        stability: plan.stability,
        scenes: Vec::new(),
        runs: Vec::new(),
        differences: Vec::new(),
        pictures: Vec::new(),
    }
}

/// The plan's part, if it isn't the whole; its files and hash are known at the end.
fn part_facts(plan: &Plan) -> Option<PartFacts> {
    (plan.part != Part::Whole).then(|| PartFacts {
        part: plan.part,
        devices: plan.devices.clone(),
        files: BTreeMap::new(),
        blake3: String::new(),
    })
}

/// A copy of `scene` with its sphere sets, if the plan reads any.
fn with_spheres(setup: &Setup<'_>, scene: &Scene) -> Result<Scene, HarnessError> {
    let (tools, mut scene) = (setup.tools, scene.clone());
    scene.notes.iter().for_each(|note| tools.progress.note(note));
    if setup.plan.needs_spheres() {
        for note in scene.build_spheres(tools.cache, tools.progress)? {
            tools.progress.note(&format!("{}: {note}", scene.name));
        }
    }
    Ok(scene)
}
