//! Fewer receivers than the smallest buffer holds.

use crate::{Strategies, on};
use glam::Vec3;
use halfshade_scene::{
    Environment, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereSet, builtin::shapes,
    progress::Silent,
};
use halfshade_strategy::StrategyError;
use libtest_mimic::Failed;
use std::sync::Arc;

/// Down to none, they get what they get among many.
pub(super) fn compare(strategies: &Strategies) -> Result<(), Failed> {
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    let pose = Pose { translation: Vec3::Y, ..Pose::IDENTITY };
    let ball = Object::new("ball", shapes::sphere(3)).spheres(Arc::new(set)).pose(pose);
    let objects = vec![Object::new("ground", shapes::plane(2)), ball];
    let scene = Scene { bounces: 1, ..Scene::at_rest("few", objects, Environment::constant(Vec3::ONE)) };
    let frame = scene.frame(0);
    let all = ReceiverBuffer::vertices(&frame);
    let strategy = on(strategies, "sh-exp");
    let shaded = |receivers: &ReceiverBuffer| -> Result<RadianceBuffer, StrategyError> {
        let mut baked = strategy.bake(&scene, &strategy.info().defaults(), &Silent)?;
        baked.place_receivers(&frame, receivers.view())?;
        let prepared = baked.prepare(&frame)?;
        let mut out = RadianceBuffer::zeros(receivers.len());
        prepared.shade(receivers.view(), out.view_mut());
        prepared.read_back(out.view_mut())?;
        Ok(out)
    };
    let told = |error: StrategyError| Failed::from(error.to_string());
    let expected = shaded(&all).map_err(told)?;
    for count in [0, 1, 3, 7, 15, 17] {
        let places: Vec<u32> = (0..count).collect();
        let found = shaded(&ReceiverBuffer::gathered(all.view(), &places)).map_err(told)?;
        for channel in 0..3 {
            if found.channels[channel] != expected.channels[channel][..count as usize] {
                return Err(format!("{count} receivers: {:?}", found.channels).into());
            }
        }
    }
    Ok(())
}
