//! Five spheres over a plane under one spherical light.
//!
//! After [Meunier2009, figure 13]: five blockers and a plane, soft shadows that overlap. Sizes and places are our own, so
//! that shadows from sharp to soft lie side by side. The spheres rise and sink in turn.

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, wave};
use super::shapes;
use crate::{Camera, Environment, Motion, Object, Pose, Scene, SphereLight};
use glam::Vec3;
use std::sync::Arc;

/// Place above the plane, radius, colour.
const BLOCKERS: [([f32; 3], f32, [f32; 3]); 5] = [
    ([-1.1, 0.55, 0.3], 0.32, [0.7, 0.3, 0.25]),
    ([-0.35, 0.42, -0.75], 0.3, [0.3, 0.55, 0.3]),
    ([0.1, 0.75, 0.25], 0.42, [0.75, 0.7, 0.6]),
    ([0.8, 0.4, -0.4], 0.26, [0.3, 0.4, 0.7]),
    ([1.05, 0.35, 0.6], 0.2, [0.7, 0.6, 0.25]),
];

pub(super) fn scene() -> Scene {
    let plane = Object::new("plane", shapes::plane(128))
        .albedo(Vec3::splat(0.75))
        .cluster_count(16)
        .pose(Pose { scale: 3.0, ..Pose::IDENTITY });
    let ball = Arc::new(shapes::sphere(16));
    let blockers = BLOCKERS.iter().enumerate().map(|(number, &(place, radius, albedo))| {
        Object::new(format!("sphere {number}"), ball.clone())
            .albedo(albedo.into())
            .sphere_count(1)
            .cluster_count(4)
            .motion(keyframes(|time| Pose {
                scale: radius,
                ..Pose::from_translation(Vec3::from(place) + 0.08 * wave(time, 1.0, 0.2 * number as f64) * Vec3::Y)
            }))
    });
    let light = SphereLight { center: Vec3::new(-1.2, 3.4, 1.0), radius: 0.5, radiance: Vec3::splat(30.0) };
    Scene {
        lights: vec![(light, Motion::Still(Pose::IDENTITY))],
        camera: Camera {
            eye: Vec3::new(0.0, 3.0, 5.0),
            target: Vec3::new(0.0, 0.2, 0.0),
            vertical_fov_degrees: 36.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest(
            "five-blockers",
            std::iter::once(plane).chain(blockers).collect(),
            Environment::constant(Vec3::ZERO),
        )
    }
}
