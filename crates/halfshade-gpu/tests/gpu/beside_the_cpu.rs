//! The device shades as the CPU does, up to rounding.

use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment, Mesh, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereLight, SphereSet,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
    progress::Silent,
};
use halfshade_strategy::{Effect, Strategy, StrategyError};
use libtest_mimic::Failed;
use std::sync::Arc;

/// Largest difference between device and CPU, as a share of the mean unshadowed radiance. Receivers next to a sphere whose
/// rim they see edge-on magnify rounding, whoever computes it.
const TOLERANCE: f32 = 2e-3;

/// The mean difference, likewise.
const MEAN_TOLERANCE: f32 = 2e-5;

/// Sizes that a strategy's scene is compared at.
pub(super) const SIZES: [f32; 3] = [1.0, 1e-15, 1e12];

pub(super) fn compare(device: &dyn Strategy, cpu: &dyn Strategy, settings: &str, sizes: &[f32]) -> Result<(), Failed> {
    for &size in sizes {
        // At the extremes of size one light tells as much as both.
        let count = if size == 1.0 { 2 } else { 1 };
        for (light, environment) in environments().into_iter().enumerate().rev().take(count) {
            let mut scene = scene(size, environment);
            if cpu.info().effects.contains(Effect::LocalLights) && has_lamp_kernel(settings) {
                scene.lights.push(lamp(size));
            }
            let receivers = ReceiverBuffer::vertices(&scene.frame(0));
            compare_in([device, cpu], &scene, &receivers, settings)
                .map_err(|problem| Failed::from(format!("size {size:e}, light {light}: {problem}")))?;
        }
    }
    Ok(())
}

/// A light beside what [`scene`] holds.
pub(super) fn lamp(size: f32) -> (SphereLight, Motion) {
    let lamp =
        SphereLight { center: size * Vec3::new(1.0, 3.0, 0.5), radius: 0.3 * size, radiance: Vec3::new(9.0, 8.0, 7.0) };
    (lamp, Motion::Still(Pose::IDENTITY))
}

/// Whether a device shades local lights with these settings, where it shades any.
pub(super) fn has_lamp_kernel(settings: &str) -> bool {
    !["bands=8", "compression="].iter().any(|without| settings.contains(without))
}

/// Holds a strategy on the device to the same on the CPU, in one scene.
pub(super) fn compare_in(
    [device, cpu]: [&dyn Strategy; 2],
    scene: &Scene,
    receivers: &ReceiverBuffer,
    settings: &str,
) -> Result<(), String> {
    let found = [device, cpu].map(|strategy| shaded(strategy, scene, receivers, settings));
    let [found, expected] = found;
    let (found, expected) = (found.map_err(told)?, expected.map_err(told)?);
    let values = |buffer: &RadianceBuffer| buffer.channels.concat();
    let (found, expected) = (values(&found), values(&expected));
    let mean = expected.iter().sum::<f32>() / expected.len() as f32;
    let off: Vec<f32> = found.iter().zip(&expected).map(|(a, b)| (a - b).abs() / mean).collect();
    // NaN is larger than any bound.
    let worst = off.iter().copied().fold(0.0, |a, b| if b <= a { a } else { b });
    let average = off.iter().sum::<f32>() / off.len() as f32;
    let [most, most_in_the_mean] = match cpu.info().name {
        // A ray that grazes an edge, or the rim of a small sun, may be decided otherwise: one of some ten thousand.
        "ray-traced" => [10.0, 2e-3],
        // So may the node of a map that is next to a direction of a lobe.
        "mask" if scene.is_glossy() => [1e-2, MEAN_TOLERANCE],
        _ => [TOLERANCE, MEAN_TOLERANCE],
    };
    if !(worst <= most && average <= most_in_the_mean) {
        return Err(format!("off by {worst:e}, {average:e} in the mean"));
    }
    Ok(())
}

fn told(error: StrategyError) -> String {
    error.to_string()
}

/// Radiance of receivers in the first frame of a scene.
pub(super) fn shaded(
    strategy: &dyn Strategy,
    scene: &Scene,
    receivers: &ReceiverBuffer,
    settings: &str,
) -> Result<RadianceBuffer, StrategyError> {
    let params = strategy.info().parse(settings).map_err(|error| StrategyError::Failed(error.to_string()))?;
    let mut baked = strategy.bake(scene, &params, &Silent)?;
    let frame = scene.frame(0);
    baked.place_receivers(&frame, receivers.view())?;
    // Another frame in between leaves no trace.
    baked.prepare(&scene.frame(1))?;
    let prepared = baked.prepare(&frame)?;
    let mut out = RadianceBuffer::zeros(receivers.len());
    prepared.shade(receivers.view(), out.view_mut());
    prepared.read_back(out.view_mut())?;
    Ok(out)
}

/// Constant light, and a map in colour with a sun.
pub(super) fn environments() -> [Environment; 2] {
    let sun =
        Sun { direction: Vec3::new(0.6, 0.48, -0.64), angular_radius: 0.2, radiance: Vec3::new(30.0, 20.0, 10.0) };
    let texel = |i: usize| Vec3::new(1.0 + (i % 7) as f32, (i % 5) as f32, 0.2 * (i % 64) as f32);
    let map = EnvironmentMap::new(64, 32, (0..64 * 32).map(texel).collect()).expect("as many texels as it is large");
    let map = DistantLight::Map(Arc::new(map));
    [Environment::constant(Vec3::new(1.0, 0.8, 0.5)), Environment { base: map, sun: Some(sun) }]
}

/// A ground, and turned, scaled and overlapping bodies of several spheres, of which some cut the ground. All are `size` times
/// as large as usual, and move.
pub(super) fn scene(size: f32, environment: Environment) -> Scene {
    let mesh: Arc<Mesh> = Arc::new(shapes::sphere(8));
    let spheres = (0..12).map(|i| {
        let angle = i as f32 * 0.9;
        Sphere {
            center: Vec3::new(0.6 * angle.cos(), 0.1 * i as f32 - 0.5, 0.5 * angle.sin()),
            radius: 0.2 + 0.03 * i as f32,
        }
    });
    let set = Arc::new(SphereSet { spheres: spheres.collect(), ..SphereSet::default() });
    let ground = Object::new("ground", shapes::plane(16)).pose(Pose { scale: 4.0 * size, ..Pose::IDENTITY });
    let body = |i: usize| {
        let pose = Pose {
            scale: (0.5 + 0.2 * i as f32) * size,
            rotation: Quat::from_rotation_z(0.4 * i as f32),
            translation: size * Vec3::new(1.4 * i as f32 - 2.0, 0.7, 0.3 * i as f32),
        };
        Object::new(format!("body {i}"), mesh.clone()).spheres(set.clone()).cluster_count(3).pose(pose)
    };
    let mut objects = vec![ground];
    objects.extend((0..4).map(body));
    Scene {
        environment_turn_per_sec: 0.3,
        frame_count: 10,
        bounces: 2,
        ..Scene::at_rest("bodies", objects, environment)
    }
}
