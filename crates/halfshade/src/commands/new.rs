//! `halfshade new`: a file to begin with.

use super::context::Context;
use crate::{
    cli::{FileChoice, NewArguments},
    failure::Failure,
};
use halfshade_harness::HarnessError;
use halfshade_scene::Progress;
use std::{fs::File, io::Write, path::PathBuf, process::ExitCode};

pub(super) fn new(context: &Context, arguments: &NewArguments) -> Result<ExitCode, Failure> {
    let (text, default, next) = match arguments.kind {
        FileChoice::Scene => (include_str!("../../templates/scene.toml"), "scene.toml", "compare"),
        FileChoice::Experiment => (include_str!("../../templates/experiment.toml"), "experiment.toml", "run"),
    };
    let path = arguments.file.clone().unwrap_or_else(|| PathBuf::from(default));
    let mut file = File::create_new(&path).map_err(|source| HarnessError::io(&path, "create", source))?;
    file.write_all(text.as_bytes()).map_err(|source| HarnessError::io(&path, "write", source))?;
    context.bars.note(&format!("wrote {0}; try: halfshade {next} {0}", path.display()));
    Ok(ExitCode::SUCCESS)
}
