//! `halfshade run`: the main job.

use super::{Context, Failure};
use crate::{cli::RunArguments, terminal};
use halfshade_harness::{
    Experiment,
    report::{provenance, tables},
    run::RunOptions,
    table::Format,
};
use halfshade_scene::Progress;
use std::{path::PathBuf, process::ExitCode};

pub(super) fn run(context: &Context, arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let experiment = Experiment::load(&arguments.experiment)?;
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(&experiment.name));
    let options = RunOptions {
        threads: context.threads,
        quick: arguments.quick,
        resume: arguments.resume,
        out: Some(out.clone()),
    };
    let results = context.with_tools(|tools| halfshade_harness::run::run(&experiment, tools, &options))?;
    let provenance = provenance(&results);
    for table in tables(&results) {
        terminal::data(&format!("{}\n", table.write(Format::Markdown, &provenance)))?;
    }
    context.bars.note(&format!("tables, plots and pictures: {}", out.join("report.md").display()));
    Ok(ExitCode::SUCCESS)
}
