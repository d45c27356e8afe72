//! `halfshade report`: tables and plots from stored results.

use super::Failure;
use crate::{
    cli::{FormatChoice, ReportArguments},
    terminal,
};
use halfshade_harness::{Results, output::prepare_folder, report, table::Format};
use std::process::ExitCode;

pub(super) fn report(arguments: &ReportArguments) -> Result<ExitCode, Failure> {
    let mut results = Results::load(&arguments.folder)?;
    // Stored results may have been parted from their pictures, which are large.
    let folder = if arguments.folder.is_dir() { Some(arguments.folder.as_path()) } else { arguments.folder.parent() };
    results.pictures.retain(|files| folder.is_some_and(|folder| folder.join(&files.png).is_file()));
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
