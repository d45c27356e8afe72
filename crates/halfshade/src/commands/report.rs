//! `halfshade report`: tables and plots from stored results.

use super::context::Context;
use crate::{
    cli::{FormatChoice, ReportArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::{
    HarnessError, Results,
    out_folder::{OutFolder, PRIVATE},
    output::{check_no_input, check_writable, prepare_folder, write_atomically},
    report::{self, Format},
};
use halfshade_scene::{Progress, input};
use std::{path::Path, process::ExitCode};

pub(super) fn report(context: &Context, arguments: &ReportArguments) -> Result<ExitCode, Failure> {
    if let Some(output) = &arguments.output {
        context.prepare_output(output)?;
    }
    let (results, inputs) = input::recorded(|| Results::load(&arguments.folder));
    let mut results = results?;
    if let Some(output) = &arguments.output {
        check_no_input(output, &inputs)?;
    }
    // Stored results may have been parted from their pictures, which are large.
    let folder = if arguments.folder.is_dir() { Some(arguments.folder.as_path()) } else { arguments.folder.parent() };
    results.pictures.retain(|files| folder.is_some_and(|folder| folder.join(&files.png).is_file()));
    let format = match arguments.format {
        FormatChoice::Md => Format::Markdown,
        FormatChoice::Csv => Format::Csv,
        FormatChoice::Latex => Format::Latex,
        FormatChoice::Html => Format::Html,
        FormatChoice::Text => Format::Text,
    };
    if arguments.folder.is_dir() && format == Format::Markdown {
        // The page refers to the plots by name.
        prepare_folder(&arguments.folder)?;
        if arguments.folder.join(PRIVATE).is_dir() {
            write_beside_run(context, &arguments.folder, &results)?;
        } else {
            report::write_plots(&results, &mut |file, bytes| write_plot(context, &arguments.folder.join(file), bytes))?;
        }
    }
    let nowhere = Path::new("");
    let text = report::report(&results, format, &report::files_in(folder.unwrap_or(nowhere)));
    match &arguments.output {
        Some(output) => write_atomically(output, text.as_bytes())?,
        None => terminal::data(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes plots into the folder of a run, which keeps a list of all that is its own.
fn write_beside_run(context: &Context, path: &Path, results: &Results) -> Result<(), HarnessError> {
    match OutFolder::open(path, &[]) {
        Ok(mut folder) => report::write_plots(results, &mut |file, bytes| folder.write(file, bytes)),
        // Who only wants to read what an earlier run found need not wait for another one.
        Err(error) => {
            context.bars.note(&format!("plots are left as they are: {error}"));
            Ok(())
        }
    }
}

/// Writes a plot, and says so where another one, or something else, was of that name.
fn write_plot(context: &Context, path: &Path, bytes: &[u8]) -> Result<(), HarnessError> {
    if std::fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|source| HarnessError::io(folder, "create", source))?;
    }
    if check_writable(path)? {
        context.bars.note(&format!("{} is replaced by a new plot", path.display()));
    }
    write_atomically(path, bytes)
}
