//! A figure walks round a corner of a courtyard: a body that moves through an arrangement that stands still.
//!
//! A red wall and a white one, four columns, and the sky of the studio: what the figure receives changes with its place, by what
//! hides the sky and by what is red.

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::ground::ground;
use super::polygonize::polygonize;
use super::{figures, shapes, studio};
use crate::{Camera, Object, Pose, Scene};
use glam::Vec3;
use std::sync::Arc;

/// Everything stands this high above the ground, so that no two faces coincide.
const GAP: f32 = 0.004;

/// The scene.
pub(super) fn scene() -> Scene {
    let wall = |name: &str, half_size: Vec3, place: Vec3, albedo: Vec3| {
        let cells = (half_size / 0.05).ceil().max(Vec3::ONE).as_usizevec3().to_array();
        let pose = Pose::from_translation(place + Vec3::new(0.0, half_size.y + GAP, 0.0));
        Object::new(name, shapes::cuboid(half_size, cells)).albedo(albedo).cluster_count(8).pose(pose)
    };
    let column_mesh = Arc::new(shapes::capsule(0.14, 32));
    let column = |number: usize| {
        let place = Vec3::new([-0.75, -0.05, 0.65, 0.65][number], 0.62 + GAP, [0.35, 0.35, 0.35, -0.35][number]);
        Object::new(format!("column {number}"), column_mesh.clone())
            .albedo(Vec3::splat(0.7))
            .cluster_count(4)
            .pose(Pose { scale: 0.62, ..Pose::from_translation(place) })
    };
    let walking = keyframes(|time| {
        let place = Vec3::new(0.75 * wave(time, 1.0, 0.0), GAP, -0.1 + 0.25 * wave(time, 1.0, 0.25));
        upright(place, 0.6 * wave(time, 1.0, 0.1), 0.7)
    });
    let mut objects = vec![
        ground(Vec3::new(1.7, 0.08, 1.3), [68, 52], Vec3::new(0.60, 0.57, 0.52), 8),
        wall("white wall", Vec3::new(1.3, 0.6, 0.06), Vec3::new(0.0, 0.0, -0.9), Vec3::splat(0.75)),
        wall("red wall", Vec3::new(0.06, 0.6, 0.7), Vec3::new(-1.24, 0.0, -0.1), Vec3::new(0.75, 0.12, 0.08)),
    ];
    objects.extend((0..4).map(column));
    objects.push(
        Object::new("figure", polygonize(&figures::draped_woman(), 0.0295))
            .sphere_count(16)
            .cluster_count(8)
            .motion(walking),
    );
    Scene {
        camera: Camera {
            eye: Vec3::new(1.4, 1.7, 4.0),
            target: Vec3::new(-0.1, 0.45, 0.0),
            vertical_fov_degrees: 31.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("courtyard", objects, studio::studio())
    }
}
