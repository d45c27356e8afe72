//! The device's clock beside the wall's.

use crate::{Strategies, on};
use glam::Vec3;
use halfshade_scene::{Environment, Object, RadianceBuffer, ReceiverBuffer, Scene, builtin::shapes, progress::Silent};
use halfshade_strategy::StrategyError;
use libtest_mimic::Failed;
use std::time::Instant;

/// Frames are shaded in some time, which is no longer than who waits for them sees go by.
pub(super) fn compare(strategies: &Strategies) -> Result<(), Failed> {
    let told = |error: StrategyError| Failed::from(error.to_string());
    let ground = Object::new("ground", shapes::plane(100));
    let scene = Scene::at_rest("clocks", vec![ground], Environment::constant(Vec3::ONE));
    let (frame, strategy) = (scene.frame(0), on(strategies, "sh-exp"));
    let receivers = ReceiverBuffer::vertices(&frame);
    let mut baked = strategy.bake(&scene, &strategy.info().defaults(), &Silent).map_err(told)?;
    baked.place_receivers(&frame, receivers.view()).map_err(told)?;
    let prepared = baked.prepare(&frame).map_err(told)?;
    let mut out = RadianceBuffer::zeros(receivers.len());
    for round in 0..20 {
        let start = Instant::now();
        prepared.shade(receivers.view(), out.view_mut());
        let wall_secs = start.elapsed().as_secs_f64();
        // A device need not have a clock.
        let Some(device_secs) = prepared.device_secs() else { return Ok(()) };
        if !(device_secs > 0.0 && device_secs <= wall_secs) {
            return Err(format!("round {round}: {device_secs} s by its clock, {wall_secs} s by the wall's").into());
        }
    }
    prepared.read_back(out.view_mut()).map_err(told)
}
