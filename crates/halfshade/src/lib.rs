//! The command, as a library for its own tests: arguments, the list of strategies, and what is printed.

mod band_limit;
mod cli;
mod commands;
mod failure;
mod revision;
mod strategies;
mod terminal;

pub use band_limit::band_limit;
pub use cli::Cli;
pub use revision::revision;
pub use strategies::strategies;

use clap::Parser;
use failure::Failure;
use std::{ffi::OsString, process::ExitCode};

/// Runs the command: 0 done, 1 a check failed, 2 bad usage or bad input.
pub fn main(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Where not even this can be printed there is nobody to tell.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match commands::dispatch(cli, arguments) {
        Ok(code) => code,
        Err(Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(Failure::Error(message)) => {
            terminal::error(&message);
            ExitCode::from(2)
        }
    }
}
