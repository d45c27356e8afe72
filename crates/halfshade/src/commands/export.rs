//! `halfshade export`: a frame of a scene for another renderer.

use super::context::Context;
use super::picture::default_output;
use crate::{
    cli::{ExportArguments, ExportChoice},
    failure::Failure,
    terminal,
};
use halfshade_harness::output::{check_new_folder, write_folder};
use halfshade_scene::{Progress, exchange::mitsuba};
use std::process::ExitCode;

pub(super) fn export(context: &Context, arguments: &ExportArguments) -> Result<ExitCode, Failure> {
    let ExportChoice::Mitsuba = arguments.format;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene, "-mitsuba"));
    check_new_folder(&output)?;
    let scene = context.scene(&arguments.scene, &output)?;
    let exported = mitsuba::export(&scene.frame(arguments.scene.frame))?;
    write_folder(&output, &exported.files)?;
    exported.notes.iter().for_each(|note| context.bars.note(note));
    let files: String = exported.files.iter().map(|(name, _)| format!("{}\n", output.join(name).display())).collect();
    terminal::data(&files)?;
    context.bars.note(&format!("wrote {}", output.display()));
    Ok(ExitCode::SUCCESS)
}
