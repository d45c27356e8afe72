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
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

pub(super) fn report(context: &Context, arguments: &ReportArguments) -> Result<ExitCode, Failure> {
    if let Some(output) = &arguments.output {
        context.prepare_output(output)?;
    }
    let load = |folder: &PathBuf| Ok((folder.display().to_string(), Results::load(folder)?));
    let (all, inputs) =
        input::recorded(|| arguments.folders.iter().map(load).collect::<Result<Vec<_>, HarnessError>>());
    let mut all = all?;
    if let Some(output) = &arguments.output {
        check_no_input(output, &inputs)?;
    }
    let format = format(arguments.format);
    let text = match (arguments.folders.as_slice(), all.as_mut_slice()) {
        ([folder], [(_, results)]) => one(context, folder, results, format)?,
        _ => report::side_by_side(&all).write(format, &|_| None),
    };
    match &arguments.output {
        Some(output) => write_atomically(output, text.as_bytes())?,
        None => terminal::data(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn format(choice: FormatChoice) -> Format {
    match choice {
        FormatChoice::Md => Format::Markdown,
        FormatChoice::Csv => Format::Csv,
        FormatChoice::Latex => Format::Latex,
        FormatChoice::Html => Format::Html,
        FormatChoice::Text => Format::Text,
    }
}

/// The report on the results in `folder`; one in Markdown draws the plots that it refers to by name.
fn one(context: &Context, folder: &Path, results: &mut Results, format: Format) -> Result<String, Failure> {
    // Stored results may have been parted from their pictures, which are large.
    let beside = if folder.is_dir() { Some(folder) } else { folder.parent() };
    results.pictures.retain(|files| beside.is_some_and(|beside| beside.join(&files.png).is_file()));
    if folder.is_dir() && format == Format::Markdown {
        prepare_folder(folder)?;
        if folder.join(PRIVATE).is_dir() {
            write_beside_run(context, folder, results)?;
        } else {
            report::write_plots(results, &mut |file, bytes| write_plot(context, &folder.join(file), bytes))?;
        }
    }
    Ok(report::report(results, format, &report::files_in(beside.unwrap_or(Path::new("")))))
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
