//! `halfshade run`: the main job.

use super::context::Context;
use crate::{
    cli::{DeviceArgument, RunArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::{
    Device, Experiment, Part,
    report::{Format, summary},
    run::RunOptions,
};
use halfshade_scene::Progress;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::ExitCode,
};

pub(super) fn run(context: &Context, arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let mut experiment = Experiment::load(&arguments.experiment)?;
    experiment.keep_only(&arguments.only)?;
    let start = Start {
        out: arguments.out.clone(),
        devices: &arguments.device,
        quick: arguments.quick,
        resume: arguments.resume,
        part: part(arguments)?,
    };
    run_experiment(context, &experiment, start)
}

/// The part that is asked for.
fn part(arguments: &RunArguments) -> Result<Part, Failure> {
    let shard = arguments.shard.map(|choice| choice.shard(&|name| std::env::var(name).ok()));
    match shard.transpose().map_err(|problem| Failure::Error(format!("--shard: {problem}")))? {
        Some(shard) => Ok(Part::Errors(shard)),
        None if arguments.times => Ok(Part::Times),
        None => Ok(Part::Whole),
    }
}

/// How a run is started.
pub(super) struct Start<'a> {
    /// Folder of results, if other than `out/NAME`.
    pub(super) out: Option<PathBuf>,
    /// Devices, if others than the experiment's.
    pub(super) devices: &'a [DeviceArgument],
    pub(super) quick: bool,
    pub(super) resume: bool,
    pub(super) part: Part,
}

/// Runs `experiment`; ends with tables, the verdicts, and where the rest lies.
pub(super) fn run_experiment(
    context: &Context,
    experiment: &Experiment,
    start: Start<'_>,
) -> Result<ExitCode, Failure> {
    let out = start.out.unwrap_or_else(|| default_folder(&experiment.name, start.part));
    let named: Vec<Device> = start.devices.iter().map(DeviceArgument::device).collect();
    let devices = if named.is_empty() { experiment.devices.clone() } else { named };
    let name = start.devices.iter().find_map(DeviceArgument::name);
    let graphics = context.graphics_for(&devices, name)?;
    let options = RunOptions {
        devices: Some(devices),
        threads: context.threads,
        quick: start.quick,
        resume: start.resume,
        part: start.part,
        out: Some(out.clone()),
        inputs: None,
    };
    on_interrupt(resume_command(&context.arguments))?;
    let results =
        context.with_tools(graphics.as_ref(), |tools| halfshade_harness::run::run(experiment, tools, &options))?;
    if start.part != Part::Whole {
        let parts = out.parent().unwrap_or(&out).display();
        let told = format!(
            "{} of {}: {}; when all parts are there: halfshade merge {parts}/*",
            start.part,
            experiment.name,
            out.display()
        );
        context.bars.note(&told);
        return Ok(ExitCode::SUCCESS);
    }
    terminal::data(&format!("{}\n", summary(&results).write(Format::Text, &|_| None)))?;
    context.bars.note(&format!("tables, plots and pictures: {}", out.join("report.html").display()));
    Ok(ExitCode::SUCCESS)
}

/// Folder of results, if none is named; parts lie beside each other.
fn default_folder(experiment: &str, part: Part) -> PathBuf {
    let out = Path::new("out");
    match part.folder_name() {
        None => out.join(experiment),
        Some(name) => out.join(format!("{experiment}-parts")).join(name),
    }
}

/// Status of a program that an interrupt ended: 128 and the signal's number.
const INTERRUPTED: i32 = 130;

/// Ctrl-C ends the run at once, which loses nothing that is in the journal, and says how to go on.
fn on_interrupt(command: String) -> Result<(), Failure> {
    ctrlc::set_handler(move || {
        terminal::interrupted(&format!("interrupted; what was measured is kept; go on with: {command}"));
        std::process::exit(INTERRUPTED);
    })
    .map_err(|error| Failure::Error(format!("cannot listen for Ctrl-C: {error}")))
}

/// The same command with `--resume`, for a shell.
fn resume_command(arguments: &[OsString]) -> String {
    let mut words: Vec<String> = arguments.iter().map(|word| quoted(&word.to_string_lossy())).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".into());
    }
    words.join(" ")
}

/// A word as a POSIX shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_to_go_on_can_be_pasted() {
        let command = |words: &[&str]| resume_command(&words.iter().map(OsString::from).collect::<Vec<_>>());
        assert_eq!(command(&["halfshade", "run", "e.toml"]), "halfshade run e.toml --resume");
        assert_eq!(command(&["halfshade", "run", "--resume", "e.toml"]), "halfshade run --resume e.toml");
        assert_eq!(command(&["h", "run", "it's here.toml"]), r"h run 'it'\''s here.toml' --resume");
        assert_eq!(command(&["h", "run", "", "$x"]), "h run '' '$x' --resume");
    }
}
