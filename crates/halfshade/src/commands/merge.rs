//! `halfshade merge`: one experiment out of its parts.

use super::context::Context;
use crate::{cli::MergeArguments, failure::Failure, terminal};
use halfshade_harness::report::{Format, summary};
use halfshade_scene::Progress;
use std::{path::PathBuf, process::ExitCode};

pub(super) fn merge(context: &Context, arguments: &MergeArguments) -> Result<ExitCode, Failure> {
    let merged = halfshade_harness::merge::merge(&arguments.parts)?;
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(&merged.results.experiment));
    merged.write(&out)?;
    terminal::data(&format!("{}\n", summary(&merged.results).write(Format::Text, &|_| None)))?;
    context.bars.note(&format!("tables, plots and pictures: {}", out.join("report.html").display()));
    Ok(ExitCode::SUCCESS)
}
