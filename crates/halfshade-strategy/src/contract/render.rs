//! The phases of a strategy on a scene of the contract.

use super::bounds::Violation;
use super::scenes;
use crate::{Baked, Effect, Params, Prepared, Strategy};
use halfshade_scene::{Frame, RadianceBuffer, RadianceMut, ReceiverBuffer, Scene, progress::Silent};

pub(super) fn baked(strategy: &dyn Strategy, params: &Params, scene: &Scene) -> Result<Box<dyn Baked>, Violation> {
    strategy.bake(scene, params, &Silent).map_err(|error| Violation(format!("bake: {error}")))
}

/// The scene with two bounces, if the strategy can model them.
pub(super) fn bounced(strategy: &dyn Strategy, scene: Scene) -> Scene {
    let bounces = if strategy.info().effects.contains(Effect::Interreflection) { 2 } else { 0 };
    Scene { bounces, ..scene }
}

/// The scene; for a strategy without light from infinitely far, lamps take that light's place, as strong as the first one's
/// constant part is.
pub(super) fn lit(strategy: &dyn Strategy, scene: Scene) -> Scene {
    if strategy.info().effects.contains(Effect::EnvironmentLight) { scene } else { scenes::by_lamps(scene) }
}

/// The frame, and the receivers that it will be shaded for.
pub(super) fn prepare<'a>(
    baked: &'a mut dyn Baked,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
) -> Result<Box<dyn Prepared + 'a>, Violation> {
    let placed = baked.place_receivers(frame, receivers.view());
    placed.map_err(|error| Violation(format!("place_receivers: {error}")))?;
    baked.prepare(frame).map_err(|error| Violation(format!("prepare: {error}")))
}

pub(super) fn shade(prepared: &dyn Prepared, receivers: &ReceiverBuffer) -> Result<RadianceBuffer, Violation> {
    // Whoever writes nothing is found out.
    let mut out = RadianceBuffer::zeros(receivers.len());
    out.channels.iter_mut().for_each(|channel| channel.fill(f32::NAN));
    prepared.shade(receivers.view(), out.view_mut());
    read_back(prepared, out.view_mut())?;
    Ok(out)
}

pub(super) fn read_back(prepared: &dyn Prepared, out: RadianceMut<'_>) -> Result<(), Violation> {
    prepared.read_back(out).map_err(|error| Violation(format!("read_back: {error}")))
}

/// The frame prepared and shaded.
pub(super) fn frame_of(
    baked: &mut dyn Baked,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
) -> Result<RadianceBuffer, Violation> {
    shade(prepare(baked, frame, receivers)?.as_ref(), receivers)
}

pub(super) fn rendered(
    strategy: &dyn Strategy,
    params: &Params,
    scene: &Scene,
    receivers: &ReceiverBuffer,
) -> Result<RadianceBuffer, Violation> {
    frame_of(baked(strategy, params, scene)?.as_mut(), &scene.frame(0), receivers)
}
