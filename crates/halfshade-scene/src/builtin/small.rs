//! Small scenes for tests and for a first look.

use super::choreography::{DURATION_SECS, FRAME_COUNT, FRAMES_PER_SEC, keyframes, wave};
use super::implicit::Body;
use super::polygonize::polygonize;
use super::{shapes, studio};
use crate::{Camera, Environment, Object, Pose, Scene};
use glam::{Quat, Vec3};
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A white sphere above a white plane under constant white light.
///
/// Unless reflected light counts, a receiver of the plane at angle γ between +Y and the sphere's centre, whose angular
/// radius is θ there, loses exactly sin²θ · cos γ of its unshadowed radiance 1. The sphere rises and sinks.
pub(super) fn one_sphere() -> Scene {
    let still = |translation| Pose { scale: 3.0, ..Pose::from_translation(translation) };
    let objects = vec![
        Object::new("plane", shapes::plane(64)).cluster_count(4).pose(still(Vec3::ZERO)),
        Object::new("sphere", shapes::sphere(20)).sphere_count(1).cluster_count(4).motion(keyframes(|time| Pose {
            scale: 0.6,
            ..Pose::from_translation(Vec3::new(0.0, 1.0 + 0.3 * wave(time, 1.0, 0.0), 0.0))
        })),
    ];
    Scene {
        camera: Camera {
            eye: Vec3::new(0.0, 2.6, 5.6),
            target: Vec3::new(0.0, 0.55, 0.0),
            vertical_fov_degrees: 36.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("one-sphere", objects, Environment::constant(Vec3::ONE))
    }
}

const CROWD_ROWS: usize = 8;

/// 64 tumbling blobs of four spheres each over a plane: many blockers that overlap within an object and as seen from
/// the ground, for tests of stability.
pub(super) fn crowd() -> Scene {
    let blob = Arc::new(polygonize(&blob(), 0.19));
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(64);
    let mut objects = vec![
        Object::new("plane", shapes::plane(64))
            .albedo(Vec3::splat(0.7))
            .cluster_count(8)
            .pose(Pose { scale: 3.0, ..Pose::IDENTITY }),
    ];
    for number in 0..CROWD_ROWS * CROWD_ROWS {
        let cell = |i: usize| (i as f32 + 0.5) / CROWD_ROWS as f32 * 2.0 - 1.0;
        let mut jitter = || random.random_range(-1.0f32..1.0);
        let place = Vec3::new(
            2.5 * cell(number % CROWD_ROWS) + 0.05 * jitter(),
            0.45 + 0.12 * jitter(),
            2.5 * cell(number / CROWD_ROWS) + 0.05 * jitter(),
        );
        let axis = Vec3::new(jitter(), jitter(), jitter()).normalize_or(Vec3::Y);
        let start = Quat::from_rotation_y(3.0 * jitter());
        let color = Vec3::new(0.55 + 0.3 * jitter(), 0.55 + 0.3 * jitter(), 0.55 + 0.3 * jitter());
        objects.push(
            Object::new(format!("blob {number}"), blob.clone()).albedo(color).sphere_count(4).cluster_count(1).motion(
                keyframes(|time| Pose {
                    scale: 0.16,
                    rotation: Quat::from_axis_angle(axis, (TAU * time / DURATION_SECS) as f32) * start,
                    translation: place,
                }),
            ),
        );
    }
    Scene {
        camera: Camera {
            eye: Vec3::new(0.0, 3.4, 6.0),
            target: Vec3::new(0.0, 0.1, 0.1),
            vertical_fov_degrees: 38.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("crowd", objects, studio::studio())
    }
}

/// Four balls at the corners of a tetrahedron, blended; within 1.4 of the origin.
fn blob() -> Body {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let (first, rest) = (corners[0], &corners[1..]);
    let at = |corner: [f64; 3]| corner.map(|x| 0.42 * x);
    let body = Body::new(0.1).sphere(at(first), 0.6, 0.0, Vec3::ONE);
    rest.iter().fold(body, |body, &corner| body.sphere(at(corner), 0.6, 0.3, Vec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;

    #[test]
    fn blobs_never_touch() {
        let reach = polygonize(&blob(), 0.19).positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        check_solid(&polygonize(&blob(), 0.19));
        let scene = crowd();
        let poses = scene.frame(0).world_from_object;
        for (i, a) in poses.iter().enumerate().skip(1) {
            assert!(a.translation.y > 1.02 * reach * a.scale, "blob {i} is in the ground");
            for b in &poses[i + 1..] {
                assert!(a.translation.distance(b.translation) > 2.02 * reach * a.scale);
            }
        }
    }
}
