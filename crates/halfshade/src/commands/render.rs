//! `halfshade render`: one picture, its time, and its error if asked for.

use super::context::Context;
use super::picture::{background, default_output, exposure, sees_nothing, told_exposure};
use crate::{
    band_limit::band_limit,
    cli::{ReceiverChoice, RenderArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::{
    Picture, ReceiverWeights, Reference, ReferenceKind, Variant,
    ability::inability,
    clock::time_secs,
    frame_time::frame_times,
    image_io::{Origin, check_extension, write_picture},
    metrics::{compare, relative},
    projection::Projection,
    reference::{Accuracy, ReferenceTracer},
    report::significant,
    results::TimeFigures,
    shading::{count_not_finite, shade_frame},
    statistics::Spread,
};
use halfshade_scene::{Frame, Progress, RadianceBuffer, ReceiverBuffer};
use halfshade_truth::Tracer;
use std::{process::ExitCode, sync::Arc};

pub(super) fn render(context: &Context, arguments: &RenderArguments) -> Result<ExitCode, Failure> {
    let variant = Variant::parse(&context.strategies, &arguments.strategy).map_err(Failure::Error)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene, ".exr"));
    check_extension(&output)?;
    context.prepare_output(&output)?;
    let mut scene = context.scene(&arguments.scene, &output)?;
    let graphics = context.graphics_for(&[arguments.device.device()], arguments.device.name())?;
    let strategy = match &graphics {
        None => context.strategies[variant.strategy].as_ref(),
        Some(graphics) => graphics.strategy(&variant.name).ok_or_else(|| {
            Failure::Error(format!("`{}` has no kernels for graphics devices yet; take --device cpu", variant.name))
        })?,
    };
    if let Some(reason) = inability(strategy, &scene, &context.strategies) {
        return Err(Failure::Error(format!("strategy `{}` {reason}", variant.name)));
    }
    if strategy.needs_spheres() {
        for note in scene.build_spheres(&context.cache, &context.bars)? {
            context.bars.note(&note);
        }
    }
    let frame = scene.frame(arguments.scene.frame);
    let tracer = Tracer::new(&frame);
    let (receivers, projection) = match arguments.receivers {
        ReceiverChoice::Pixels => Projection::of_pixels(&tracer, &scene.camera),
        ReceiverChoice::Vertices => {
            (ReceiverBuffer::vertices(&frame), Projection::of_vertices(&tracer, &frame, &scene.camera))
        }
    };
    if projection.is_empty() {
        return Err(sees_nothing(&scene));
    }
    let failed = |error: halfshade_strategy::StrategyError| Failure::Error(format!("`{}`: {error}", variant.label));
    let (bake_secs, baked) = time_secs(&context.clock, || strategy.bake(&scene, &variant.params, &context.bars));
    let mut baked = baked.map_err(failed)?;
    let radiance = shade_frame(baked.as_mut(), &frame, receivers.view()).map_err(failed)?;
    let broken = count_not_finite(&radiance);
    if broken > 0 {
        return Err(Failure::Error(format!("`{}`: {broken} values are not finite", variant.label)));
    }
    let device = arguments.device.device();
    let times =
        frame_times(&context.clock, device, baked.as_mut(), &frame, &receivers, TIMED_FRAMES).map_err(failed)?;
    tell_times(&TimeFigures { bake_secs, ..times })?;
    let picture = projection.picture(&radiance, background(&arguments.picture));
    let mut layers = vec![(String::new(), picture)];
    if arguments.truth {
        let truth = truth_of(context, arguments, &frame, &receivers)?;
        tell_error(&radiance, &truth)?;
        let truth = projection.picture(&truth.radiance, background(&arguments.picture));
        let error = layers[0].1.minus(&truth);
        layers.extend([("truth".to_owned(), truth), ("error".to_owned(), error)]);
    }
    let exposure = exposure(&layers[0].1, &arguments.picture);
    let layers: Vec<(&str, &Picture)> = layers.iter().map(|(name, picture)| (name.as_str(), picture)).collect();
    let origin = Origin {
        program: context.revision,
        scene: &scene.name,
        frame: arguments.scene.frame,
        strategy: &variant.label,
        truth_samples: arguments.truth.then_some(arguments.samples),
    };
    write_picture(&output, &layers, exposure, &origin)?;
    context.bars.note(&format!("wrote {}{}", output.display(), told_exposure(&output, exposure)));
    Ok(ExitCode::SUCCESS)
}

/// Frames that are timed; the median is told.
const TIMED_FRAMES: usize = 5;

fn tell_times(times: &TimeFigures) -> Result<(), Failure> {
    let median = |spread: Option<Spread>| spread.map_or_else(|| "none".to_owned(), |it| significant(it.median, 3));
    terminal::data(&format!(
        "threads: {}\nbake_secs: {}\nprepare_secs: {}\nshade_secs: {}\nframes_per_sec: {}\n",
        times.threads,
        significant(times.bake_secs, 3),
        median(times.prepare_secs),
        median(times.shade_secs),
        times.frames_per_sec.map_or_else(|| "none".to_owned(), |rate| significant(rate, 3))
    ))
}

/// The truth over the same receivers.
fn truth_of(
    context: &Context,
    arguments: &RenderArguments,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
) -> Result<Reference, Failure> {
    let weights = match arguments.receivers {
        ReceiverChoice::Pixels => ReceiverWeights::equal(receivers.len()),
        ReceiverChoice::Vertices => ReceiverWeights::by_area(frame, receivers),
    };
    let tracer = ReferenceTracer {
        accuracy: Accuracy { samples: arguments.samples, relative_noise: None, seed: 1 },
        band_limit: &band_limit,
        cache: &context.cache,
        progress: &context.bars,
    };
    let scoring = (Arc::new(weights), Arc::default());
    let traced = tracer.trace(frame.scene, frame.index, receivers.view(), ReferenceKind::Mesh, scoring)?;
    Ok(traced.0)
}

fn tell_error(radiance: &RadianceBuffer, truth: &Reference) -> Result<(), Failure> {
    let Some(metrics) = compare(radiance, truth) else { return Ok(()) };
    let share = |value: f64| {
        relative(value, truth.unshadowed_mean).map_or_else(|| "none".to_owned(), |value| significant(value, 3))
    };
    terminal::data(&format!(
        "rel_rmse: {}\nrel_bias: {}\nrel_p95: {}\nrel_max: {}\nresolved: {}\nrelative_standard_error: {}\n",
        share(metrics.rmse),
        share(metrics.bias),
        share(metrics.p95),
        share(metrics.max),
        metrics.resolved,
        share(truth.rms_standard_error())
    ))
}
