//! The command, as a library for its own tests: arguments, the list of strategies, and what is printed.

mod band_limit;
mod cli;
mod commands;
mod terminal;

pub use band_limit::band_limit;
pub use cli::Cli;

use clap::Parser;
use halfshade_scene::Cache;
use halfshade_strategies::{CosineLobe, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::Strategy;
use std::{ffi::OsString, process::ExitCode};

/// Every strategy there is; the only list. `cache` is for what they bake.
pub fn strategies(cache: &Cache) -> Vec<Box<dyn Strategy>> {
    vec![
        Box::new(Unshadowed),
        Box::new(RayTraced),
        Box::new(ShExp),
        Box::new(ShadowField::new(cache.clone())),
        Box::new(CosineLobe),
    ]
}

/// Version and, where it is known, the commit.
pub fn revision() -> String {
    match env!("HALFSHADE_COMMIT") {
        "" => env!("CARGO_PKG_VERSION").to_owned(),
        commit => format!("{} ({commit})", env!("CARGO_PKG_VERSION")),
    }
}

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
        Err(commands::Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(commands::Failure::Error(message)) => {
            terminal::error(&message);
            ExitCode::from(2)
        }
    }
}
