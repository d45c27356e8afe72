//! `halfshade compare`: strategies on scenes, without an experiment file.

use super::{
    context::Context,
    run::{Start, run_experiment},
};
use crate::{cli::CompareArguments, failure::Failure, terminal};
use halfshade_harness::{Part, Variant, experiment::Comparison};
use std::process::ExitCode;

pub(super) fn compare(context: &Context, arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    for spec in arguments.strategy.iter().chain(&arguments.baseline) {
        Variant::parse(&context.strategies, spec).map_err(Failure::Error)?;
    }
    let mut strategies = context.named_or_all(&arguments.strategy);
    // Who is named as the baseline is meant to run.
    strategies.extend(arguments.baseline.iter().filter(|spec| !strategies.contains(spec)).cloned().collect::<Vec<_>>());
    let comparison = arguments.settings.comparison("compare", arguments.scenes.clone(), strategies);
    let (baseline, pictures) = (arguments.baseline.clone(), !arguments.no_pictures);
    let comparison = Comparison { baseline, pictures, ..comparison };
    if arguments.print {
        terminal::data(&comparison.text())?;
        return Ok(ExitCode::SUCCESS);
    }
    let start = Start {
        out: arguments.out.clone(),
        devices: &arguments.settings.device,
        quick: arguments.quick,
        resume: arguments.resume,
        part: Part::Whole,
    };
    run_experiment(context, &comparison.experiment()?, start)
}
