//! `shadow-field` on the device beside the CPU where there is all of it: gloss, lamps around bodies, receivers between vertices.

use super::{
    beside_the_cpu::{compare_in, environments, scene},
    surfaces::{add_gloss, add_lamps, between_vertices},
};
use glam::Vec3;
use halfshade_scene::{Environment, progress::Silent};
use halfshade_strategy::{Strategy, StrategyError};
use libtest_mimic::Failed;

pub(super) fn compare(strategies: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        // Projected own occlusion is that of diffuse receivers.
        if !settings.contains("own=projected") {
            add_gloss(&mut scene);
        }
        add_lamps(&mut scene);
        scene.camera.eye = Vec3::new(0.5, 3.0, 4.0);
        let receivers = between_vertices(&scene.frame(0));
        compare_in(strategies, &scene, &receivers, settings).map_err(|problem| format!("light {light}: {problem}"))?;
    }
    Ok(())
}

/// Settings without kernels are refused before anything is baked, with what to take instead.
pub(super) fn refuses(device: &dyn Strategy) -> Result<(), Failed> {
    let scene = scene(1.0, Environment::constant(Vec3::ONE));
    for (settings, instead) in
        [("basis=haar", "basis=sh"), ("bands=7", "fewer"), ("sampling=traced", "sampling=adaptive")]
    {
        let params = device.info().parse(settings).map_err(|error| error.to_string())?;
        match device.bake(&scene, &params, &Silent) {
            Err(StrategyError::Unsupported(reason)) if reason.contains(instead) => {}
            Err(error) => return Err(format!("{settings}: {error}").into()),
            Ok(_) => return Err(format!("{settings} is baked").into()),
        }
    }
    Ok(())
}

/// From 8 to 16 and from 16 to 32 bits fields need as many bytes more as on the CPU.
pub(super) fn fills_as_much_memory(strategies: [&dyn Strategy; 2]) -> Result<(), Failed> {
    let scene = scene(1.0, Environment::constant(Vec3::ONE));
    let bytes = |strategy: &dyn Strategy, storage: &str| {
        let settings = format!("shells=6,inner=1,resolution=8,map=16,sampling=fixed,storage={storage}");
        let params = strategy.info().parse(&settings).map_err(|error| error.to_string())?;
        let baked = strategy.bake(&scene, &params, &Silent).map_err(|error| error.to_string())?;
        let is_field = |part: &&(&str, usize)| ["occlusion fields", "fields and frame on the device"].contains(&part.0);
        // Parts on the device come last.
        baked.footprint().parts.iter().rfind(is_field).map(|part| part.1).ok_or("no fields".to_owned())
    };
    for [few, many] in [["u8", "f16"], ["f16", "f32"]] {
        let grown = |strategy| Ok::<_, String>(bytes(strategy, many)? - bytes(strategy, few)?);
        let [device, cpu] = strategies.map(grown);
        let (device, cpu) = (device?, cpu?);
        if device != cpu {
            return Err(format!("from {few} to {many}: {device} bytes more instead of {cpu}").into());
        }
    }
    Ok(())
}
