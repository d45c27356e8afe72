//! `prt` on the device beside the CPU: receivers between vertices, from behind and nowhere, coloured surfaces.

use super::{
    beside_the_cpu::{compare_in, environments, scene},
    surfaces::{add_gloss, between_vertices},
};
use glam::Vec3;
use halfshade_scene::{ReceiverBuffer, Reflectance};
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

/// Every model of reflectance and a sharp lobe, at vertices, between them and nowhere.
pub(super) fn shades_gloss(strategies: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        add_gloss(&mut scene);
        scene.bounces = light % 2;
        scene.objects[4].material.reflectance = Reflectance::Phong { specular: Vec3::splat(30.0), exponent: 2000.0 };
        scene.camera.eye = Vec3::new(0.5, 3.0, 4.0);
        let frame = scene.frame(0);
        for receivers in [ReceiverBuffer::vertices(&frame), between_vertices(&frame)] {
            compare_in(strategies, &scene, &receivers, settings)
                .map_err(|problem| Failed::from(format!("light {light}: {problem}")))?;
        }
    }
    Ok(())
}
