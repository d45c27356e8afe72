//! An object on the ground shades it alike however large the ground is.

use crate::scenes::{object, on_the_ground, room, run, scene, square};
use glam::Vec3;
use halfshade_scene::{Environment, Mesh, Pose, ReceiverBuffer, Scene, builtin};
use halfshade_truth::{Options, Tracer};
use std::f64::consts::TAU;

const SKY: Environment = Environment::constant(Vec3::ONE);
const OPTIONS: Options = Options {
    geometry: halfshade_truth::Geometry::Mesh,
    transport: halfshade_truth::Transport::Shadowed,
    samples: 4096,
    noise_target: None,
    bounces: 0,
    max_samples: 4096,
    seed: 5,
};
const GROUNDS: [f32; 4] = [3.0, 1e3, 1e5, 1e7];

/// The box from `min` to `max`, faces outward.
fn block(min: Vec3, max: Vec3) -> Mesh {
    let mut mesh = room();
    let half = 0.5 * (max - min);
    mesh.positions.iter_mut().for_each(|p| *p = min + half * (*p + Vec3::ONE));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

fn on_ground(scale: f32, cells: usize, block: Mesh) -> Scene {
    let ground = object(square(cells), Pose { scale, ..Pose::IDENTITY });
    scene(vec![ground, object(block, Pose::IDENTITY)], SKY, vec![])
}

/// Fraction of the sky that is open at the foot of a wall of half width `w` and height `h`, at distance `d` in front of
/// its middle: 1 less the form factor of a rectangle at right angles.
fn open(w: f64, h: f64, d: f64) -> f64 {
    let far = h.hypot(d);
    1.0 - 2.0 / TAU * ((w / d).atan() - d / far * (w / far).atan())
}

#[test]
fn contact_shadows_have_their_closed_form_on_any_ground() {
    let (half, height) = (0.1, 0.2);
    let distances = [1e-6_f32, 1e-4, 1e-3, 0.02, 0.1];
    for cells in [1, 2, 7] {
        let mut first = None;
        for scale in GROUNDS {
            let scene = on_ground(scale, cells, block(Vec3::new(-half, 0.0, -half), Vec3::new(half, height, half)));
            let receivers = on_the_ground(distances.iter().flat_map(|d| [(half + d, 0.0), (0.0, -half - d)]));
            let estimate = run(&scene, &receivers, &OPTIONS);
            for (i, &value) in estimate.radiance.channels[0].iter().enumerate() {
                let place = receivers.view().position_at(i);
                let distance = f64::from(place.x.max(-place.z)) - f64::from(half);
                let expected = open(f64::from(half), f64::from(height), distance);
                let error = 5.0 * f64::from(estimate.standard_error.channels[0][i]) + 1e-3;
                assert!(
                    (f64::from(value) - expected).abs() < error,
                    "{scale} {cells} {place}: {value}, not {expected}"
                );
            }
            // The same samples meet the same object.
            let first = first.get_or_insert_with(|| estimate.radiance.clone());
            for (a, b) in first.channels[0].iter().zip(&estimate.radiance.channels[0]) {
                assert!((a - b).abs() < 1e-3, "{scale} {cells}: {b} instead of {a}");
            }
        }
    }
}

#[test]
fn walls_see_half_the_sky_down_to_the_ground() {
    for scale in [1e3, 1e5, 1e7] {
        let scene = on_ground(scale, 1, block(Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.2, 0.1)));
        let mut receivers = ReceiverBuffer::default();
        for height in [0.0, 1e-6, 1e-4, 1e-2, 0.1] {
            receivers.push(Vec3::new(0.1, height, 0.03), Vec3::X, Vec3::ONE, 1);
            receivers.push(Vec3::new(-0.02, height, 0.1), Vec3::Z, Vec3::ONE, 1);
        }
        for &value in &run(&scene, &receivers, &OPTIONS).radiance.channels[0] {
            assert!((value - 0.5).abs() < 5e-3, "{scale}: {value}");
        }
    }
}

#[test]
fn a_thin_plate_shades_what_it_lies_on() {
    let thickness = 1e-4_f32;
    for scale in GROUNDS {
        let scene = on_ground(scale, 1, block(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, thickness, 0.5)));
        let beside = 2e-4;
        let mut receivers = on_the_ground([(0.0, 0.0), (0.499, 0.2), (0.5 + beside, 0.0)]);
        receivers.push(Vec3::new(0.1, thickness, 0.2), Vec3::Y, Vec3::ONE, 1);
        let found = run(&scene, &receivers, &OPTIONS).radiance;
        let values = found.channels[0].as_slice();
        assert!(values[..2] == [0.0, 0.0] && (values[3] - 1.0).abs() < 1e-6, "{scale}: {values:?}");
        let distance = f64::from(0.5 + beside) - 0.5;
        let expected = open(0.5, f64::from(thickness), distance);
        assert!((f64::from(values[2]) - expected).abs() < 5e-3, "{scale}: {values:?}, not {expected}");
    }
}

/// Where coordinates are coarse the shadow is that of the rounded geometry.
#[test]
fn far_from_the_origin_what_single_precision_holds_is_shaded() {
    let middle = Vec3::new(7e4, 0.0, 3e4);
    for scale in [1e5, 1e7] {
        let block = block(middle - Vec3::new(0.5, 0.0, 0.5), middle + Vec3::new(0.5, 1.0, 0.5));
        let scene = on_ground(scale, 1, block);
        let receivers = on_the_ground([0.0625, 0.25, 1.0].map(|d| (middle.x + 0.5 + d, middle.z)));
        let estimate = run(&scene, &receivers, &OPTIONS);
        for (i, distance) in [0.0625, 0.25, 1.0].into_iter().enumerate() {
            let (found, expected) = (f64::from(estimate.radiance.at(i).x), open(0.5, 1.0, distance));
            assert!((found - expected).abs() < 5e-3, "{scale} {distance}: {found}, not {expected}");
        }
    }
}

#[test]
fn corners_of_huge_rooms_are_closed() {
    for scale in [1e2, 1e5, 1e7] {
        // One corner at the origin.
        let walls = Pose { scale, ..Pose::from_translation(Vec3::splat(scale)) };
        let scene = scene(vec![object(room(), walls)], SKY, vec![]);
        let mut receivers = ReceiverBuffer::default();
        for axis in 0..3 {
            for (near, far) in [(0.0, 0.0), (0.0, 0.3), (1e-5, 1e-5), (1e-3, 0.7), (0.02, 0.02), (0.1, 30.0)] {
                let mut place = Vec3::ZERO;
                place[(axis + 1) % 3] = near;
                place[(axis + 2) % 3] = far;
                receivers.push(place, Vec3::AXES[axis], Vec3::ONE, 0);
            }
        }
        let estimate = run(&scene, &receivers, &OPTIONS);
        assert!(estimate.radiance.channels[0].iter().all(|&v| v == 0.0), "{scale}: {:?}", estimate.radiance);
    }
}

#[test]
fn reflected_light_is_the_same_on_any_larger_ground() {
    let receivers = {
        let mut receivers = on_the_ground([(0.11, 0.0), (0.2, 0.1)]);
        for height in [1e-3, 0.05] {
            receivers.push(Vec3::new(0.1, height, 0.0), Vec3::X, Vec3::ONE, 1);
        }
        receivers
    };
    let options = Options { bounces: 1, ..OPTIONS };
    let at = |scale| {
        let block = block(Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.2, 0.1));
        run(&on_ground(scale, 1, block), &receivers, &options)
    };
    let (small, large) = (at(1e3), at(1e7));
    for i in 0..receivers.len() {
        let error = 5.0 * small.standard_error.at(i).x.hypot(large.standard_error.at(i).x);
        let (a, b) = (small.radiance.at(i).x, large.radiance.at(i).x);
        assert!((a - b).abs() < error, "{i}: {b} instead of {a} ± {error}");
    }
}

/// Where a camera looks at the ground is found to single precision of the place itself.
#[test]
fn surfaces_are_met_where_the_ray_meets_them() {
    for scale in [3.0, 1e5, 1e7] {
        let scene = on_ground(scale, 2, block(Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.2, 0.1)));
        let tracer = Tracer::new(&scene.frame(0));
        let eye = Vec3::new(0.4, 0.5, 0.8);
        for i in 0..50 {
            let target = Vec3::new(0.2 + 0.01 * i as f32, 0.0, 0.7 - 0.013 * i as f32);
            let direction = (target - eye).normalize();
            let hit = tracer.closest_hit(eye, direction).unwrap();
            let found = tracer.receiver_at(&hit, direction).position.as_dvec3();
            let exact = eye.as_dvec3() - direction.as_dvec3() * (f64::from(eye.y) / f64::from(direction.y));
            assert!(hit.object == 0 && found.distance(exact.with_y(0.0)) < 1e-7, "{scale}: {found} {exact}");
            assert!(found.y == 0.0);
        }
    }
}

/// At the rim of a slab whose top is flat to the last bit, rays start close above it but are unsure where its sides are.
#[test]
fn the_rim_of_a_slab_sees_the_whole_sky() {
    let slab = builtin::scene("vases").unwrap().objects[0].clone();
    let scene = scene(vec![slab], SKY, vec![]);
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    let estimate = run(&scene, &receivers, &Options { samples: 256, ..OPTIONS });
    let mut count = 0;
    for i in (0..receivers.len()).filter(|&i| receivers.normal[1][i] == 1.0) {
        let (value, albedo) = (estimate.radiance.channels[0][i], receivers.albedo[0][i]);
        assert!((value - albedo).abs() < 1e-3, "{i}: {value}");
        count += 1;
    }
    assert!(count > 1000, "{count}");
}
