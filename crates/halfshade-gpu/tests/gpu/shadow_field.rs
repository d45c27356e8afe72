//! `shadow-field` on the device beside the CPU where there is all of it: gloss, lamps around bodies, receivers between vertices.

use super::beside_the_cpu::{compare_in, environments, scene};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame, Gloss, LafortuneLobe, Motion, Pose, ReceiverBuffer, ReceiverPoint, Reflectance, Scene,
    SphereLight, SurfacePoint, progress::Silent,
};
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

/// Every model of reflectance, on an object each; the last stays diffuse.
fn add_gloss(scene: &mut Scene) {
    let lobe = |axis: Vec3, exponent: f32| LafortuneLobe { scale: Vec3::new(0.3, 0.2, 0.1), axis, exponent };
    let models = [
        Reflectance::ModifiedPhong { specular: Vec3::new(0.2, 0.1, 0.0), exponent: 9.0 },
        Reflectance::Phong { specular: Vec3::new(0.1, 0.2, 0.3), exponent: 4.5 },
        Reflectance::Lafortune { lobes: vec![lobe(Vec3::new(-1.0, -0.4, 0.9), 7.0), lobe(Vec3::splat(0.8), 2.0)] },
        Reflectance::Phong { specular: Vec3::ONE, exponent: 0.0 },
    ];
    for (object, model) in scene.objects.iter_mut().zip(models) {
        object.material.albedo *= 0.7;
        object.material.reflectance = model;
    }
}

/// One above all, one that holds a body, one that holds the centre of a body.
fn add_lamps(scene: &mut Scene) {
    let places = [(Vec3::new(1.0, 3.0, 0.5), 0.3), (Vec3::new(-1.9, 0.8, 0.1), 1.0), (Vec3::new(0.9, 1.2, 0.6), 0.6)];
    let lamps = places.map(|(center, radius)| SphereLight { center, radius, radiance: Vec3::new(3.0, 2.0, 1.0) });
    scene.lights.extend(lamps.map(|lamp| (lamp, Motion::Still(Pose::IDENTITY))));
}

/// A receiver within every third triangle, some from behind, with gloss that varies; and one that is nowhere on its object.
fn between_vertices(frame: &Frame<'_>) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    for (object, pose) in frame.world_from_object.iter().enumerate() {
        let mesh = &frame.scene.objects[object].mesh;
        for (triangle, corners) in mesh.triangles.iter().enumerate().step_by(3) {
            let share = (triangle % 8) as f32 / 8.0;
            let barycentric = [0.25, 0.75 * share, 0.75 * (1.0 - share)];
            let mixed =
                |values: &[Vec3]| corners.iter().zip(barycentric).map(|(&k, w)| w * values[k as usize]).sum::<Vec3>();
            let from_behind = triangle % 21 == 0;
            let normal = pose.rotation * mixed(&mesh.normals).normalize_or(Vec3::Y);
            receivers.add(&ReceiverPoint {
                position: pose.rotation * (pose.scale * mixed(&mesh.positions)) + pose.translation,
                normal: if from_behind { -normal } else { normal },
                albedo: Vec3::new(0.7, 0.6, share),
                gloss: Gloss { specular: Vec3::new(1.0, share, 0.5), exponent: 0.5 + share },
                object: object as u32,
                surface: SurfacePoint::Triangle { triangle: triangle as u32, barycentric, from_behind },
            });
        }
    }
    receivers.push(Vec3::new(0.3, 0.4, 0.5), Vec3::Y, Vec3::ONE, 0);
    receivers
}
