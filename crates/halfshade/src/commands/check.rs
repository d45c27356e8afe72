//! `halfshade check`: has an error grown?

use super::context::Context;
use crate::{cli::CheckArguments, failure::Failure, terminal};
use halfshade_harness::{
    Experiment, HarnessError, Results,
    check::{check_baseline, compare},
    report::Format,
    run::RunOptions,
};
use halfshade_scene::Progress;
use std::process::ExitCode;

pub(super) fn check(context: &Context, arguments: &CheckArguments) -> Result<ExitCode, Failure> {
    let mut experiment = Experiment::load(&arguments.experiment)?;
    let baseline = Results::load(&arguments.baseline)?;
    if baseline.experiment != experiment.name {
        return Err(Failure::Error(format!(
            "{}: the baseline is of experiment `{}`, not `{}`",
            arguments.baseline.display(),
            baseline.experiment,
            experiment.name
        )));
    }
    let of_baseline = |error: HarnessError| Failure::Error(format!("{}: {error}", arguments.baseline.display()));
    check_baseline(&baseline).map_err(of_baseline)?;
    // Errors compare only if receivers count as they did for the baseline.
    if let Some(weights) = baseline.vertex_weights().filter(|weights| *weights != experiment.weights) {
        let asked = experiment.weights;
        context.bars.note(&format!(
            "vertices count by `{weights}`, as for the baseline, not by `{asked}`, as the experiment says: renew the baseline"
        ));
        experiment.weights = weights;
    }
    let options = RunOptions {
        threads: context.threads,
        quick: baseline.quick,
        inputs: baseline.inputs.clone(),
        ..RunOptions::default()
    };
    let graphics = context.graphics_for(&experiment.devices, None)?;
    let results =
        context.with_tools(graphics.as_ref(), |tools| halfshade_harness::run::run(&experiment, tools, &options))?;
    if results.experiment_hash != baseline.experiment_hash {
        context.bars.note("the experiment file has changed since the baseline was made");
    }
    if baseline.inputs.is_none() && results.inputs.as_ref().is_some_and(|inputs| !inputs.is_empty()) {
        context.bars.note("the baseline doesn't tell what its scenes were read from: they may have changed since");
    }
    let comparison = compare(&results, &baseline).map_err(of_baseline)?;
    if !comparison.moved.rows.is_empty() {
        terminal::data(&comparison.moved.write(Format::Markdown, ""))?;
    }
    let verdict = format!(
        "{} errors compared, {} failed ({} figures)",
        comparison.compared, comparison.failures, comparison.figures
    );
    terminal::data(&format!("{verdict}\n"))?;
    Ok(if comparison.failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
