//! `halfshade completions`: a script for a shell.

use crate::{
    cli::{Cli, CompletionsArguments},
    failure::Failure,
    terminal,
};
use clap::CommandFactory;
use std::process::ExitCode;

pub(super) fn completions(arguments: &CompletionsArguments) -> Result<ExitCode, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "halfshade", &mut script);
    terminal::data(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}
