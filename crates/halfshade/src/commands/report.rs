//! `halfshade report`: tables and plots from stored results.

use super::Failure;
use crate::{
    cli::{FormatChoice, ReportArguments},
    terminal,
};
use halfshade_harness::{Results, output::prepare_folder, report, table::Format};
use std::process::ExitCode;

pub(super) fn report(arguments: &ReportArguments) -> Result<ExitCode, Failure> {
    let results = Results::load(&arguments.folder)?;
    let format = match arguments.format {
        FormatChoice::Md => Format::Markdown,
        FormatChoice::Csv => Format::Csv,
        FormatChoice::Latex => Format::Latex,
        FormatChoice::Html => Format::Html,
    };
    if arguments.folder.is_dir() && format == Format::Markdown {
        // The page refers to the plots by name.
        prepare_folder(&arguments.folder)?;
        report::write_plots(&results, &arguments.folder)?;
    }
    terminal::data(&report::report(&results, format))?;
    Ok(ExitCode::SUCCESS)
}
