//! `halfshade truth`: the truth alone, with its standard error.

use super::context::Context;
use super::picture::{background, default_output, exposure, sees_nothing, told_exposure};
use crate::{cli::TruthArguments, failure::Failure, terminal};
use glam::Vec3;
use halfshade_harness::{
    image_io::{Origin, check_extension, write_picture},
    metrics::relative,
    projection::Projection,
    reference::check_range,
    report::significant,
};
use halfshade_scene::Progress;
use halfshade_truth::{Options, Tracer, estimate};
use std::process::ExitCode;

pub(super) fn truth(context: &Context, arguments: &TruthArguments) -> Result<ExitCode, Failure> {
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene, "-truth.exr"));
    check_extension(&output)?;
    context.prepare_output(&output)?;
    let scene = context.scene(&arguments.scene, &output)?;
    let frame = scene.frame(arguments.scene.frame);
    let tracer = Tracer::new(&frame);
    let (receivers, projection) = Projection::of_pixels(&tracer, &scene.camera);
    if projection.is_empty() {
        return Err(sees_nothing(&scene));
    }
    let options =
        Options { samples: arguments.samples, seed: arguments.seed, bounces: scene.bounces, ..Options::default() };
    let found = estimate(&tracer, receivers.view(), &options, &context.bars);
    let place = format!("scene `{}`, frame {}", scene.name, arguments.scene.frame);
    check_range([&found.radiance, &found.standard_error], &found.draws, found.unshadowed_mean, &place)?;
    let picture = projection.picture(&found.radiance, background(&arguments.picture));
    let relative = relative(found.rms_standard_error, found.unshadowed_mean);
    let stderr = projection.picture(&found.standard_error, Vec3::ZERO);
    let exposure = exposure(&picture, &arguments.picture);
    let origin = Origin {
        program: context.revision,
        scene: &scene.name,
        frame: arguments.scene.frame,
        strategy: "truth",
        truth_samples: Some(found.samples),
    };
    write_picture(&output, &[("", &picture), ("stderr", &stderr)], exposure, &origin)?;
    terminal::data(&format!(
        "receivers: {}\nsamples: {}\nrms_standard_error: {:.3e}\nrelative_standard_error: {}\nunshadowed_mean: {}\n",
        receivers.len(),
        found.samples,
        found.rms_standard_error,
        relative.map_or("none".into(), |value| format!("{value:.3e}")),
        significant(found.unshadowed_mean, 7)
    ))?;
    context.bars.note(&format!("wrote {}{}", output.display(), told_exposure(&output, exposure)));
    Ok(ExitCode::SUCCESS)
}
