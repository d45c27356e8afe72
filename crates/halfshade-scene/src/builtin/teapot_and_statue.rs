//! A teapot and a statue on a slab ([Tamura2006, 6.1, figure 8]): an object alike in all directions, a long one, a flat
//! one.

use super::choreography::{DURATION_SECS, FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::ground::ground;
use super::polygonize::polygonize;
use super::{figures, studio, toys};
use crate::{Camera, Mesh, Motion, Object, Scene};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Both stand this high above the slab, so that no two faces coincide.
const GAP: f32 = 0.004;

/// The scene.
pub(super) fn scene() -> Scene {
    let object = |name: &str, mesh: Mesh, spheres: usize, motion: Motion| {
        Object::new(name, mesh).sphere_count(spheres).cluster_count(8).motion(motion)
    };
    let turning = keyframes(|time| {
        let yaw = 0.6 + TAU * (time / DURATION_SECS) as f32;
        upright(Vec3::new(-0.55, GAP, 0.25), yaw, 1.0)
    });
    let sliding = keyframes(|time| {
        let place = Vec3::new(0.55 + 0.15 * wave(time, 1.0, 0.0), GAP, -0.15);
        upright(place, -FRAC_PI_2 - 0.3 + 0.4 * wave(time, 1.0, 0.25), 1.0)
    });
    let objects = vec![
        ground(Vec3::new(1.6, 0.08, 1.2), [96, 72], Vec3::new(0.60, 0.57, 0.52), 6),
        object("teapot", toys::teapot().mesh, 16, turning),
        object("statue", polygonize(&figures::draped_woman(), 0.0295), 12, sliding),
    ];
    Scene {
        camera: Camera {
            eye: Vec3::new(0.0, 1.9, 4.4),
            target: Vec3::new(0.0, 0.6, 0.0),
            vertical_fov_degrees: 28.0,
            resolution: [900, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("teapot-and-statue", objects, studio::studio())
    }
}
