//! One file per command.

mod check;
mod compare;
mod completions;
mod context;
mod export;
mod list;
mod man;
mod merge;
mod new;
mod picture;
mod render;
mod report;
mod run;
mod schema;
mod spheres;
mod truth;
mod tune;

use crate::{
    cli::{Cli, Command},
    failure::Failure,
};
use context::Context;
use halfshade_scene::Cache;
use halfshade_strategy::Strategy;
use std::{ffi::OsString, process::ExitCode};

/// Does what was asked, with `more` strategies than our own.
pub(crate) fn dispatch(
    cli: Cli,
    arguments: Vec<OsString>,
    more: impl FnOnce(&Cache) -> Vec<Box<dyn Strategy>>,
) -> Result<ExitCode, Failure> {
    let context = Context::new(cli.global, arguments, more);
    match cli.command {
        Command::Run(arguments) => run::run(&context, &arguments),
        Command::Compare(arguments) => compare::compare(&context, &arguments),
        Command::Check(arguments) => check::check(&context, &arguments),
        Command::Merge(arguments) => merge::merge(&context, &arguments),
        Command::List(arguments) => list::list(&context, &arguments),
        Command::Report(arguments) => report::report(&context, &arguments),
        Command::New(arguments) => new::new(&context, &arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments),
        Command::Man(arguments) => man::man(&arguments),
        Command::Tune(arguments) => tune::tune(&context, &arguments),
        Command::Render(arguments) => on_threads(&context, || render::render(&context, &arguments)),
        Command::Truth(arguments) => on_threads(&context, || truth::truth(&context, &arguments)),
        Command::Export(arguments) => export::export(&context, &arguments),
        Command::Spheres(arguments) => on_threads(&context, || spheres::spheres(&context, &arguments)),
    }
}

fn on_threads<T: Send>(context: &Context, work: impl FnOnce() -> Result<T, Failure> + Send) -> Result<T, Failure> {
    halfshade_harness::threads::with_threads(context.threads, work)?
}
