//! `halfshade schema`: the keys of files that people write.

use crate::{
    cli::{FileChoice, SchemaArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::experiment;
use halfshade_scene::{file, keys::reference};
use std::process::ExitCode;

pub(super) fn schema(arguments: &SchemaArguments) -> Result<ExitCode, Failure> {
    let schema = match arguments.kind {
        FileChoice::Scene => file::schema(),
        FileChoice::Experiment => experiment::schema(),
    };
    terminal::data(&if arguments.markdown { reference(&schema) } else { format!("{schema:#}\n") })?;
    Ok(ExitCode::SUCCESS)
}
