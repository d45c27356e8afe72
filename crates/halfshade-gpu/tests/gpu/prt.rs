//! `prt` on the device beside the CPU: receivers between vertices, from behind and nowhere, coloured surfaces.

use super::{
    beside_the_cpu::{compare_in, environments, scene},
    surfaces::between_vertices,
};
use glam::Vec3;
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;

pub(super) fn compare(strategies: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        scene.bounces = 1;
        scene.objects[0].material.albedo = Vec3::new(0.8, 0.5, 0.2);
        let receivers = between_vertices(&scene.frame(0));
        compare_in(strategies, &scene, &receivers, settings).map_err(|problem| format!("light {light}: {problem}"))?;
    }
    Ok(())
}
