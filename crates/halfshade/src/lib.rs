//! The command `halfshade` as a library: arguments, the list of strategies, and what is printed.
//!
//! It is for tests, and for programs that add a strategy of their own with [`main_with`] (GUIDE.md shows one):
//!
//! ```
//! use halfshade_scene::Cache;
//!
//! let names: Vec<&str> = halfshade::strategies(&Cache::disabled()).iter().map(|strategy| strategy.info().name).collect();
//! assert!(names.contains(&"unshadowed") && names.contains(&"ray-traced"));
//! ```

mod band_limit;
mod cli;
mod commands;
mod failure;
mod progress;
mod revision;
mod strategies;
mod terminal;

pub use band_limit::band_limit;
pub use cli::Cli;
pub use revision::REVISION;
pub use strategies::strategies;

use clap::Parser;
use failure::Failure;
use halfshade_scene::Cache;
use halfshade_strategy::Strategy;
use std::{ffi::OsString, process::ExitCode};

/// Runs the command: 0 done, 1 a check failed, 2 bad usage or bad input.
pub fn main(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    main_with(arguments, |_| Vec::new())
}

/// Runs the command with `more` strategies, which it is given a cache to make them with: for crates that add a method of their own.
pub fn main_with(
    arguments: impl Iterator<Item = OsString>,
    more: impl FnOnce(&Cache) -> Vec<Box<dyn Strategy>>,
) -> ExitCode {
    let arguments: Vec<OsString> = arguments.collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Where not even this can be printed there is nobody to tell.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match commands::dispatch(cli, arguments, more) {
        Ok(code) => code,
        Err(Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(Failure::Error(message)) => {
            terminal::error(&message);
            ExitCode::from(2)
        }
    }
}

#[cfg(doctest)]
#[doc = include_str!("../../../GUIDE.md")]
struct Guide;
