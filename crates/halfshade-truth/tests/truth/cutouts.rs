//! Holes that alpha masks cut: what is left blocks, and nothing else.

use crate::scenes::{assert_agrees, object, on_the_ground, run, scene, square};
use glam::{Vec2, Vec3};
use halfshade_scene::{Environment, Mesh, Pose, Texture, mesh::AlphaMask, texture::Wrap};
use halfshade_truth::{Options, Tracer};
use std::{f64::consts::PI, sync::Arc};

/// The square |x|, |z| ≤ 1 of `n` by `n` cells, whose alpha falls from 1 at x = -1/2 to 0 at x = 1/2.
fn masked(n: usize) -> Mesh {
    let alpha = Texture::new(2, 1, vec![Vec3::ONE, Vec3::ZERO]).unwrap().wrapped([Wrap::Clamp; 2]);
    let mesh = square(n);
    Mesh {
        texture_coordinates: mesh.positions.iter().map(|p| Vec3::new(0.5 + 0.5 * p.x, 0.5, 0.0)).collect(),
        masks: vec![AlphaMask { texture: Some(Arc::new(alpha)), cutoff: 0.5 }],
        coverage: vec![Vec2::X; mesh.positions.len()],
        ..mesh
    }
}

/// Share of a constant sky's irradiance that a rectangle blocks which lies parallel to the receiver at height 1, with a
/// corner above it and sides `a` and `b`; signed as these are.
fn corner(a: f64, b: f64) -> f64 {
    let half = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
    (half(a, b) + half(b, a)) / (2.0 * PI)
}

#[test]
fn what_a_mask_leaves_blocks_as_a_rectangle_does() {
    let ground = object(square(2), Pose { scale: 4.0, ..Pose::IDENTITY });
    for n in [1, 5] {
        let above = object(masked(n), Pose::from_translation(Vec3::Y));
        let scene = scene(vec![above, ground.clone()], Environment::constant(Vec3::ONE), vec![]);
        let places: Vec<(f32, f32)> =
            (0..49).map(|i| (-1.5 + 0.5 * (i % 7) as f32 + 0.03, -1.5 + 0.5 * (i / 7) as f32 + 0.02)).collect();
        let receivers = on_the_ground(places);
        let expected = |i: usize| {
            let place = receivers.view().position_at(i).as_dvec3();
            let to = |x: f64, z: f64| corner(x - place.x, z - place.z);
            1.0 - (to(0.0, 1.0) - to(-1.0, 1.0) - to(0.0, -1.0) + to(-1.0, -1.0))
        };
        let options = Options { samples: 16384, ..Options::default() };
        assert_agrees(&run(&scene, &receivers, &options), expected, 2e-3, 1e-4);
    }
}

#[test]
fn a_picture_shows_what_is_behind_a_hole() {
    let ground = object(square(1), Pose { scale: 4.0, ..Pose::IDENTITY });
    let above = object(masked(3), Pose::from_translation(Vec3::Y));
    let scene = scene(vec![above, ground], Environment::constant(Vec3::ONE), vec![]);
    let tracer = Tracer::new(&scene.frame(0));
    for (x, seen) in [(-0.9, 0), (-0.01, 0), (0.01, 1), (0.9, 1)] {
        let from = Vec3::new(x, 3.0, 0.1);
        assert_eq!(tracer.closest_hit(from, Vec3::NEG_Y).unwrap().object, seen, "{x}");
        // Only the ground is in the way of a ray from below.
        assert_eq!(tracer.occluded(Vec3::new(x, 0.5, 0.1), Vec3::Y), seen == 0, "{x}");
    }
}
