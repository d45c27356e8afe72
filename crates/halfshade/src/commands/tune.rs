//! `halfshade tune`: which strategy, set how, for an error and a frame's time.

use super::context::Context;
use crate::{
    cli::{DeviceArgument, TuneArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::{
    Device,
    experiment::Comparison,
    report::{Format, summary},
    run::RunOptions,
    tune::{Bounds, tune as search},
};
use halfshade_scene::Progress;
use std::{path::PathBuf, process::ExitCode};

/// Bytes of a MiB.
const MIB: f64 = 1_048_576.0;

pub(super) fn tune(context: &Context, arguments: &TuneArguments) -> Result<ExitCode, Failure> {
    let strategies = context.named_or_all(&arguments.only);
    let settings = &arguments.settings;
    let comparison = settings.comparison("tune", vec![arguments.scene.clone()], strategies);
    let comparison = Comparison { pictures: false, ..comparison };
    let bounds = Bounds {
        error: arguments.max_error,
        frame_secs: arguments.frame_ms.map(|ms| 1e-3 * ms),
        bytes: arguments.memory_mb.map(|mib| MIB * mib),
    };
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(comparison.name()));
    let named: Vec<Device> = settings.device.iter().map(DeviceArgument::device).collect();
    let devices = if named.is_empty() { vec![Device::Cpu] } else { named };
    let graphics = context.graphics_for(&devices, settings.device.iter().find_map(DeviceArgument::name))?;
    let options = RunOptions {
        devices: Some(devices),
        threads: context.threads,
        out: Some(out.clone()),
        ..RunOptions::default()
    };
    let threads = context.threads;
    let outcome = halfshade_harness::threads::with_threads(threads, || {
        context.with_tools(graphics.as_ref(), |tools| search(&comparison, &bounds, tools, &options))
    })??;
    terminal::data(&format!("{}\n{outcome}\n", summary(&outcome.results).write(Format::Text, &|_| None)))?;
    context.bars.note(&format!("tables and plots: {}", out.join("report.html").display()));
    Ok(if outcome.choice.meets_bounds { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
