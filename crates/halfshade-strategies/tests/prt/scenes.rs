//! Scenes and light for tests of transfer.

use glam::{DVec3, Quat, Vec3};
use halfshade_scene::{
    Environment, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, builtin::shapes, light::EnvironmentMap,
};
use halfshade_sh::basis;
use halfshade_strategies::Prt;
use halfshade_strategy::Prepared;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A coloured map of so many bands that is positive everywhere. Its texels are as small as they must be for the bands beyond to be
/// of no account.
pub(crate) fn limited_light(bands: usize, seed: u64) -> Environment {
    let (width, height) = (256, 128);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut channel = || -> Vec<f64> { (0..bands * bands).map(|_| random.random_range(-1.0..1.0)).collect() };
    let vectors = [channel(), channel(), channel()];
    let texel = |i: usize| {
        let polar = (i / width) as f64 + 0.5;
        let azimuth = (i % width) as f64 + 0.5 - 0.5 * width as f64;
        let (polar, azimuth) =
            (polar * std::f64::consts::PI / height as f64, azimuth * std::f64::consts::TAU / width as f64);
        // Row 0 is the zenith, the centre column -Z.
        let direction = DVec3::new(polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos());
        let y = basis::evaluate(bands, direction.to_array());
        Vec3::from(vectors.each_ref().map(|vector| basis::dot(vector, &y) as f32))
    };
    let texels: Vec<Vec3> = (0..width * height).map(texel).collect();
    let least = texels.iter().copied().reduce(Vec3::min).unwrap();
    let positive = texels.into_iter().map(|texel| texel - least + 0.1).collect();
    Environment::map(EnvironmentMap::new(width, height, positive).unwrap())
}

/// A tilted torus over the ground: both hide light from the other, the torus from itself.
pub(crate) fn torus_over_ground(environment: Environment, [ground, torus]: [Vec3; 2]) -> Scene {
    let tilted = Pose { rotation: Quat::from_rotation_x(0.5), ..Pose::from_translation(Vec3::new(0.1, 1.0, 0.0)) };
    let objects = vec![
        Object::new("ground", shapes::plane(12)).albedo(ground).pose(Pose { scale: 2.0, ..Pose::IDENTITY }),
        Object::new("torus", shapes::torus(0.8, 0.35, 40, 20)).albedo(torus).pose(tilted),
    ];
    Scene::at_rest("torus over ground", objects, environment)
}

/// The vertices of a scene's first frame, shaded by transfer.
pub(crate) fn vertices(scene: &Scene, settings: &str) -> (ReceiverBuffer, RadianceBuffer) {
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    let radiance = crate::common::shaded(&Prt::default(), scene, &frame, &receivers, settings);
    (receivers, radiance)
}

/// Receivers shaded so many at a time.
pub(crate) fn in_batches(prepared: &dyn Prepared, receivers: &ReceiverBuffer, size: usize) -> RadianceBuffer {
    let mut out = RadianceBuffer::zeros(receivers.len());
    let mut rest = out.view_mut();
    for start in (0..receivers.len()).step_by(size) {
        let end = (start + size).min(receivers.len());
        let (part, after) = rest.split_at(end - start);
        prepared.shade(receivers.view().slice(start..end), part);
        rest = after;
    }
    out
}
