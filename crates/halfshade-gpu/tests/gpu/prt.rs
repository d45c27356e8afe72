//! `prt` on the device beside the CPU: receivers between vertices, from behind and nowhere, coloured and translucent surfaces.

use super::{
    beside_the_cpu::{compare_in, environments, has_lamp_kernel, lamp, scene},
    surfaces::{add_gloss, between_vertices},
};
use glam::Vec3;
use halfshade_scene::{Environment, ReceiverBuffer, Reflectance, Subsurface, progress::Silent};
use halfshade_strategy::{Strategy, StrategyError};
use libtest_mimic::Failed;

pub(super) fn compare(strategies: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        scene.bounces = 1;
        scene.objects[0].material.albedo = Vec3::new(0.8, 0.5, 0.2);
        if light == 1 && has_lamp_kernel(settings) {
            scene.lights.push(lamp(1.0));
        }
        if light == 2 {
            scene.objects[1].material.subsurface = Some(Subsurface {
                absorption: Vec3::new(0.1, 0.4, 2.0),
                reduced_scattering: Vec3::new(20.0, 12.0, 8.0),
                refractive_index: 1.3,
            });
        }
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
        if light == 1 {
            scene.lights.push(lamp(1.0));
        }
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

/// Local lights with settings that have no kernel for them are refused, and it says which.
pub(super) fn refuses(device: &dyn Strategy) -> Result<(), Failed> {
    let mut scene = scene(1.0, Environment::constant(Vec3::ONE));
    scene.lights.push(lamp(1.0));
    for (settings, what) in [
        ("bands=7", "six bands"),
        ("lamp-steps=2", "lamp-steps"),
        ("window=hann", "window"),
        ("compression=vq,clusters=9", "compression"),
    ] {
        let settings = format!("transfer=unshadowed,{settings}");
        let params = device.info().parse(&settings).map_err(|error| error.to_string())?;
        match device.bake(&scene, &params, &Silent) {
            Err(StrategyError::Unsupported(reason)) if reason.contains(what) && reason.contains("device `cpu`") => {}
            Err(error) => return Err(format!("{settings}: {error}").into()),
            Ok(_) => return Err(format!("{settings} is baked").into()),
        }
    }
    Ok(())
}
