//! Holes that alpha masks cut, in strategies that trace rays: against the closed form of what is left.

use crate::common::shaded;
use glam::{Vec2, Vec3};
use halfshade_scene::{
    Environment, Mesh, Object, Pose, ReceiverBuffer, Scene, Texture, builtin::shapes, mesh::AlphaMask, texture::Wrap,
};
use halfshade_strategies::ray_traced::RayTraced;
use halfshade_strategy::Strategy;
use std::{f64::consts::PI, sync::Arc};

fn object(mesh: Mesh, pose: Pose) -> Object {
    Object::new("object", mesh).albedo(Vec3::ONE).pose(pose)
}

/// The square |x|, |z| ≤ 1, of which a mask leaves x < 0.
fn masked() -> Mesh {
    let alpha = Texture::new(2, 1, vec![Vec3::ONE, Vec3::ZERO]).unwrap().wrapped([Wrap::Clamp; 2]);
    let mesh = shapes::plane(4);
    Mesh {
        texture_coordinates: mesh.positions.iter().map(|p| Vec3::new(0.5 + 0.5 * p.x, 0.5, 0.0)).collect(),
        masks: vec![AlphaMask { texture: Some(Arc::new(alpha)), cutoff: 0.5 }],
        coverage: vec![Vec2::X; mesh.positions.len()],
        ..mesh
    }
}

/// Share of a constant sky that a rectangle at height 1 hides with a corner above the receiver and sides `a` and `b`.
fn corner(a: f64, b: f64) -> f64 {
    let half = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
    (half(a, b) + half(b, a)) / (2.0 * PI)
}

/// Mean error over vertices of the ground, with a blocker of this mesh above.
fn error(strategy: &dyn Strategy, settings: &str, blocker: Mesh) -> f64 {
    let ground = object(shapes::plane(8), Pose { scale: 1.5, ..Pose::IDENTITY });
    let objects = vec![ground, object(blocker, Pose::from_translation(Vec3::Y))];
    let scene = Scene::at_rest("masked", objects, Environment::constant(Vec3::ONE));
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    let radiance = shaded(strategy, &scene, &frame, &receivers, settings);
    let count = scene.objects[0].mesh.positions.len();
    let error_at = |i: usize| {
        let place = receivers.view().position_at(i).as_dvec3();
        let to = |x: f64, z: f64| corner(x - place.x, z - place.z);
        let seen = 1.0 - (to(0.0, 1.0) - to(-1.0, 1.0) - to(0.0, -1.0) + to(-1.0, -1.0));
        (f64::from(radiance.channels[0][i]) - seen).abs()
    };
    (0..count).map(error_at).sum::<f64>() / count as f64
}

#[test]
fn rays_pass_through_holes() {
    let whole = Mesh { masks: Vec::new(), coverage: Vec::new(), ..masked() };
    let rays = |mesh: Mesh| error(&RayTraced, "unfiltered,samples=4096", mesh);
    assert!(rays(masked()) < 0.01, "{}", rays(masked()));
    assert!(rays(whole) > 0.05);
}
