//! Fewer receivers than the smallest buffer holds.

use crate::{Strategies, beside_the_cpu::shaded, on};
use glam::Vec3;
use halfshade_scene::{Environment, Object, Pose, ReceiverBuffer, Scene, Sphere, SphereSet, builtin::shapes};
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
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let strategy = on(strategies, "sh-exp");
    let shaded = |receivers: &ReceiverBuffer| shaded(strategy, &scene, receivers, "");
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
