//! Glossy surfaces by `mask`.

use crate::{
    beside_the_cpu::{compare_in, environments, scene},
    surfaces::{add_gloss, add_lamps, between_vertices},
};
use glam::Vec3;
use halfshade_scene::{ReceiverBuffer, Reflectance};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;

/// Every model of reflectance and a sharp lobe under every kind of light, at vertices and between them.
pub(super) fn shades_gloss([device, cpu]: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        add_gloss(&mut scene);
        add_lamps(&mut scene);
        scene.objects[4].material.reflectance = Reflectance::Phong { specular: Vec3::splat(30.0), exponent: 2000.0 };
        scene.camera.eye = Vec3::new(0.5, 3.0, 4.0);
        let frame = scene.frame(0);
        for receivers in [ReceiverBuffer::vertices(&frame), between_vertices(&frame)] {
            compare_in([device, cpu], &scene, &receivers, settings)
                .map_err(|problem| Failed::from(format!("light {light}: {problem}")))?;
        }
    }
    Ok(())
}
