//! Five long figures on a ground box that somebody moves about ([Tamura2006, 6, figure 9]: 6 objects, 32,875 vertices).

use super::choreography::{DURATION_SECS, FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::ground::ground;
use super::lathe::lathe;
use super::polish::polished;
use super::polygonize::polygonize;
use super::profile::spline_profile;
use super::{figures, studio};
use crate::{Camera, Material, Mesh, Object, Pose, Scene, SphereLight};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Statues stand this high above the ground, so that no two faces coincide.
const GAP: f32 = 0.004;

/// A statue's mesh, its place on the ground, how it is pushed and turned about, and how many spheres follow its shape.
struct Statue {
    name: &'static str,
    mesh: fn() -> Mesh,
    place: Vec2,
    slide: Vec2,
    /// Direction in which it looks: radians from +Z toward +X.
    facing: f32,
    /// Full turns about its axis over the time line, and radians by which it turns back and forth.
    turns: f32,
    swing: f32,
    phase: f64,
    polished: bool,
    spheres: usize,
}

const STATUES: [Statue; 5] = [
    Statue {
        name: "draped woman",
        mesh: || polygonize(&figures::draped_woman(), 0.0295),
        place: Vec2::new(0.1, 0.15),
        slide: Vec2::new(0.0, 0.14),
        facing: 0.2,
        turns: 1.0,
        swing: 0.0,
        phase: 0.0,
        polished: false,
        spheres: 12,
    },
    Statue {
        name: "walker",
        mesh: || polygonize(&figures::walker(), 0.024),
        place: Vec2::new(1.15, 0.5),
        slide: Vec2::new(0.16, 0.10),
        facing: -0.9,
        turns: 0.0,
        swing: 0.7,
        phase: 0.3,
        polished: false,
        spheres: 16,
    },
    Statue {
        name: "stone head",
        mesh: || polygonize(&figures::stone_head(), 0.029),
        place: Vec2::new(-1.1, 0.5),
        slide: Vec2::new(0.10, -0.16),
        facing: 0.55,
        turns: 0.0,
        swing: 0.5,
        phase: 0.55,
        polished: true,
        spheres: 8,
    },
    Statue {
        name: "totem",
        mesh: || polygonize(&figures::totem(), 0.030),
        place: Vec2::new(-0.62, -0.92),
        slide: Vec2::new(0.12, 0.0),
        facing: 0.35,
        turns: 0.0,
        swing: 0.6,
        phase: 0.8,
        polished: false,
        spheres: 14,
    },
    Statue {
        name: "queen",
        mesh: queen,
        place: Vec2::new(0.72, -0.85),
        slide: Vec2::new(-0.12, 0.08),
        facing: 0.0,
        turns: -1.0,
        swing: 0.0,
        phase: 0.15,
        polished: true,
        spheres: 10,
    },
];

/// The scene.
pub(super) fn scene() -> Scene {
    let mut objects = vec![ground(Vec3::new(2.2, 0.15, 1.8), [117, 81], Vec3::new(0.60, 0.57, 0.52), 6)];
    objects.extend(STATUES.iter().map(|statue| {
        Object::new(statue.name, (statue.mesh)())
            .material(if statue.polished { polished(Vec3::ONE) } else { Material::default() })
            .sphere_count(statue.spheres)
            .cluster_count(8)
            .motion(keyframes(|time| {
                let along = statue.place + statue.slide * wave(time, 1.0, statue.phase);
                let turned = statue.turns * TAU * (time / DURATION_SECS) as f32;
                // The figures look along +X.
                let yaw = statue.facing - FRAC_PI_2 + turned + statue.swing * wave(time, 1.0, statue.phase + 0.25);
                upright(Vec3::new(along.x, GAP, along.y), yaw, 1.0)
            }))
    }));
    Scene {
        lights: vec![
            (
                SphereLight { center: Vec3::ZERO, radius: 0.20, radiance: Vec3::new(26.0, 19.0, 12.0) },
                keyframes(|time| {
                    Pose::from_translation(Vec3::new(
                        -1.7 + 0.5 * wave(time, 1.0, 0.6),
                        1.9,
                        1.1 + 0.7 * wave(time, 1.0, 0.85),
                    ))
                }),
            ),
            (
                SphereLight { center: Vec3::ZERO, radius: 0.16, radiance: Vec3::new(11.0, 16.0, 28.0) },
                keyframes(|time| {
                    Pose::from_translation(Vec3::new(
                        1.9 + 0.2 * wave(time, 1.0, 0.0),
                        1.5,
                        -0.2 + 1.2 * wave(time, 1.0, 0.1),
                    ))
                }),
            ),
        ],
        camera: Camera {
            eye: Vec3::new(0.0, 2.2, 5.6),
            target: Vec3::new(0.03, 0.75, -0.1),
            vertical_fov_degrees: 27.5,
            resolution: [900, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("statues", objects, studio::studio().scaled(0.4))
    }
}

/// The queen of a game of chess, of dark wood.
pub(super) fn queen() -> Mesh {
    const CONTROLS: [[f64; 2]; 27] = [
        [0.0, 0.0],
        [0.30, 0.0],
        [0.37, 0.01],
        [0.37, 0.09],
        [0.30, 0.13],
        [0.31, 0.18],
        [0.29, 0.24],
        [0.20, 0.29],
        [0.155, 0.42],
        [0.125, 0.65],
        [0.115, 0.86],
        [0.13, 0.95],
        [0.22, 0.985],
        [0.23, 1.02],
        [0.15, 1.045],
        [0.14, 1.08],
        [0.19, 1.10],
        [0.19, 1.14],
        [0.125, 1.16],
        [0.15, 1.26],
        [0.20, 1.42],
        [0.235, 1.50],
        [0.19, 1.52],
        [0.10, 1.55],
        [0.06, 1.60],
        [0.09, 1.70],
        [0.0, 1.72],
    ];
    const PROFILE_POINTS: usize = 77;
    const SEGMENTS: usize = 44;
    let mut mesh = lathe(&spline_profile(&CONTROLS, PROFILE_POINTS), SEGMENTS);
    let (wood, brass) = (Vec3::new(0.30, 0.11, 0.05), Vec3::new(0.72, 0.50, 0.18));
    mesh.colors = mesh.positions.iter().map(|p| if p.y > 1.555 { brass } else { wood }).collect();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::tests::built;

    #[test]
    fn statues_stand_on_their_foot() {
        for object in &built("statues").objects[1..] {
            let lowest = object.mesh.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
            assert!(lowest.abs() < 0.01, "{}: {lowest}", object.name);
        }
    }

    #[test]
    fn statues_never_touch() {
        let scene = built("statues");
        let radius = |mesh: &Mesh| mesh.positions.iter().map(|p| p.with_y(0.0).length()).fold(0.0, f32::max);
        let radii: Vec<f32> = scene.objects.iter().map(|object| radius(&object.mesh)).collect();
        for index in 0..scene.frame_count {
            let poses = scene.frame(index).world_from_object;
            for i in 1..poses.len() {
                for j in i + 1..poses.len() {
                    let between = (poses[i].translation - poses[j].translation).with_y(0.0);
                    let room = between.length() - radii[i] - radii[j];
                    let (a, b) = (&scene.objects[i].name, &scene.objects[j].name);
                    assert!(room > 0.01, "{a} and {b} at frame {index}: {room}");
                }
            }
        }
    }
}
