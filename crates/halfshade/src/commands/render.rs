//! `halfshade render`: one picture.

use super::context::Context;
use super::picture::{background, default_output, exposure, sees_nothing};
use crate::{
    cli::{ReceiverChoice, RenderArguments},
    failure::Failure,
};
use halfshade_harness::{
    Variant,
    image_io::{check_extension, write_picture},
    projection::Projection,
    shading::{count_not_finite, shade_frame},
};
use halfshade_scene::{Progress, ReceiverBuffer};
use halfshade_strategy::Effects;
use halfshade_truth::Tracer;
use std::process::ExitCode;

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
    let missing = strategy.info().effects.missing(Effects::required_by(&scene));
    if !missing.is_empty() {
        return Err(Failure::Error(format!("`{}` can't model {missing}, which the scene requires", variant.name)));
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
    let mut baked = strategy.bake(&scene, &variant.params, &context.bars).map_err(failed)?;
    let radiance = shade_frame(baked.as_mut(), &frame, receivers.view()).map_err(failed)?;
    let broken = count_not_finite(&radiance);
    if broken > 0 {
        return Err(Failure::Error(format!("`{}`: {broken} values are not finite", variant.label)));
    }
    let picture = projection.picture(&radiance, background(&arguments.scene));
    write_picture(&output, &[("", &picture)], exposure(&picture, &arguments.scene))?;
    context.bars.note(&format!("wrote {}", output.display()));
    Ok(ExitCode::SUCCESS)
}
