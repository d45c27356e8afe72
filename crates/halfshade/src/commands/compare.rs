//! `halfshade compare`: strategies on scenes, without an experiment file.

use super::{
    context::Context,
    run::{Start, run_experiment},
};
use crate::{
    cli::{CompareArguments, ReceiverChoice},
    failure::Failure,
    terminal,
};
use halfshade_harness::{Part, ReceiverKind, Variant, experiment::Comparison};
use std::process::ExitCode;

pub(super) fn compare(context: &Context, arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    for spec in arguments.strategy.iter().chain(&arguments.baseline) {
        Variant::parse(&context.strategies, spec).map_err(Failure::Error)?;
    }
    let all = || context.strategies.iter().map(|strategy| strategy.info().name.to_owned()).collect();
    let mut strategies: Vec<String> = if arguments.strategy.is_empty() { all() } else { arguments.strategy.clone() };
    // Who is named as the baseline is meant to run.
    strategies.extend(arguments.baseline.iter().filter(|spec| !strategies.contains(spec)).cloned().collect::<Vec<_>>());
    let comparison = Comparison {
        purpose: "compare",
        scenes: arguments.scenes.clone(),
        environment: arguments.env.clone(),
        strategies,
        baseline: arguments.baseline.clone(),
        frame: arguments.frame,
        still: arguments.still,
        receivers: match arguments.receivers {
            ReceiverChoice::Pixels => ReceiverKind::Pixels,
            ReceiverChoice::Vertices => ReceiverKind::Vertices,
        },
        samples: arguments.samples,
        pictures: !arguments.no_pictures,
    };
    if arguments.print {
        terminal::data(&comparison.text())?;
        return Ok(ExitCode::SUCCESS);
    }
    let start = Start {
        out: arguments.out.clone(),
        devices: &arguments.device,
        quick: arguments.quick,
        resume: arguments.resume,
        part: Part::Whole,
    };
    run_experiment(context, &comparison.experiment()?, start)
}
