//! Answers that are known without tracing anything.

use crate::scenes::{assert_agrees, ball, normals_around, object, on_the_ground, run, scene, square};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Pose, ReceiverBuffer, SphereLight,
    light::{EnvironmentMap, Sun},
    spheres::AdjustRule,
};
use halfshade_truth::{Geometry, Options, Transport};
use std::f64::consts::PI;

const SKY: Environment = Environment::constant(Vec3::ONE);
const SPHERES: Geometry = Geometry::Spheres(AdjustRule::Continuous);

/// Fraction of a constant sky's irradiance that a sphere wholly above the horizon blocks: sin²θ cos γ.
fn blocked_by(center: DVec3, radius: f64, receiver: DVec3, normal: DVec3) -> f64 {
    let offset = center - receiver;
    (radius / offset.length()).powi(2) * offset.normalize().dot(normal)
}

fn grid() -> Vec<(f32, f32)> {
    (0..144).map(|i| (-1.5 + 0.25 * (i % 12) as f32 + 0.01, -1.5 + 0.25 * (i / 12) as f32 + 0.02)).collect()
}

fn ground_point(receivers: &ReceiverBuffer, i: usize) -> DVec3 {
    receivers.view().position_at(i).as_dvec3()
}

#[test]
fn a_sphere_over_a_plane_blocks_sine_squared_times_cosine() {
    let (center, radius) = (Vec3::new(0.1, 1.0, -0.2), 0.6);
    let scene =
        scene(vec![object(square(4), Pose { scale: 3.0, ..Pose::IDENTITY }), ball(center, radius)], SKY, vec![]);
    let receivers = on_the_ground(grid());
    let expected = |i| 1.0 - blocked_by(center.as_dvec3(), f64::from(radius), ground_point(&receivers, i), DVec3::Y);
    for (geometry, model_error) in [(Geometry::Mesh, 3e-5), (SPHERES, 1e-6)] {
        for samples in [1024, 16384] {
            let options = Options { geometry, samples, ..Options::default() };
            let estimate = run(&scene, &receivers, &options);
            assert_eq!(estimate.samples, samples);
            assert_agrees(&estimate, expected, if samples == 1024 { 5e-3 } else { 1e-3 }, model_error);
        }
    }
}

#[test]
fn two_spheres_apart_add() {
    let balls = [(Vec3::new(-0.9, 1.0, 0.0), 0.5), (Vec3::new(0.9, 0.9, 0.1), 0.6)];
    let scene = scene(balls.iter().map(|&(center, radius)| ball(center, radius)).collect(), SKY, vec![]);
    // Between the two, where their outlines are far from touching.
    let receivers = on_the_ground((0..100).map(|i| (-0.2 + 0.04 * (i % 10) as f32, -0.2 + 0.04 * (i / 10) as f32)));
    let expected = |i| {
        let at = ground_point(&receivers, i);
        1.0 - balls.iter().map(|&(c, r)| blocked_by(c.as_dvec3(), f64::from(r), at, DVec3::Y)).sum::<f64>()
    };
    for (geometry, model_error) in [(Geometry::Mesh, 5e-5), (SPHERES, 1e-6)] {
        let options = Options { geometry, samples: 16384, seed: 5, ..Options::default() };
        assert_agrees(&run(&scene, &receivers, &options), expected, 1e-3, model_error);
    }
}

#[test]
fn a_square_over_a_plane_blocks_its_form_factor() {
    let (height, half) = (0.7, 0.5);
    let pose = Pose { scale: half, ..Pose::from_translation(Vec3::new(0.0, height, 0.0)) };
    let ground = object(square(2), Pose { scale: 5.0, ..Pose::IDENTITY });
    let scene = scene(vec![ground, object(square(3), pose)], SKY, vec![]);
    let receivers = on_the_ground(grid());
    // Lambert: the irradiance of a polygon is half the sum, over its edges, of the angle that the edge subtends times
    // the cosine between the normal and the plane through the edge and the receiver.
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, z)| DVec3::new(x * f64::from(half), f64::from(height), z * f64::from(half)));
    let expected = |i| {
        let at = ground_point(&receivers, i);
        let sum: f64 = (0..4)
            .map(|k| {
                let (a, b) = ((corners[k] - at).normalize(), (corners[(k + 1) % 4] - at).normalize());
                a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().y
            })
            .sum();
        1.0 - (0.5 * sum).abs() / PI
    };
    let options = Options { samples: 8192, seed: 9, ..Options::default() };
    assert_agrees(&run(&scene, &receivers, &options), expected, 1e-3, 1e-6);
}

/// Receivers at the origin with many normals, so that everything on the +Y axis is seen under one angle.
fn at_the_origin(spread: f64, count: usize) -> (ReceiverBuffer, Vec<DVec3>) {
    let normals = normals_around(DVec3::Y, spread, count);
    let mut receivers = ReceiverBuffer::default();
    normals.iter().for_each(|normal| receivers.push(Vec3::ZERO, normal.as_vec3(), Vec3::ONE, 0));
    (receivers, normals)
}

#[test]
fn a_sphere_light_behind_a_smaller_sphere_is_a_ring() {
    // Light of angular sine 0.3, blocker in front of it of sine 0.2; a second blocker behind the light changes nothing.
    let black = Environment::constant(Vec3::ZERO);
    let light = SphereLight { center: Vec3::Y * 4.0, radius: 1.2, radiance: Vec3::new(5.0, 1.0, 0.0) };
    let balls = vec![ball(Vec3::Y * 2.0, 0.4), ball(Vec3::Y * 8.0, 2.7)];
    let scene = scene(balls, black, vec![light]);
    let (receivers, normals) = at_the_origin(1.2, 100);
    for (geometry, model_error) in [(Geometry::Mesh, 1e-4), (SPHERES, 1e-5)] {
        let options = Options { geometry, samples: 4096, ..Options::default() };
        let estimate = run(&scene, &receivers, &options);
        assert_agrees(&estimate, |i| 5.0 * (0.09 - 0.04) * normals[i].y, 1e-3, model_error);
        assert!(estimate.radiance.channels[2].iter().all(|&blue| blue == 0.0));
    }
}

#[test]
fn a_wide_light_across_the_horizon_and_one_around_the_receiver() {
    let black = Environment::constant(Vec3::ZERO);
    let (receivers, normals) = at_the_origin(2.5, 120);
    // A blocker far away from the light, so that samples are traced at all.
    let far = || vec![ball(Vec3::Y * 90.0, 1.0)];
    let wide = SphereLight { center: Vec3::Y, radius: 0.95, radiance: Vec3::ONE };
    let exact = run(&scene(vec![], black.clone(), vec![wide]), &receivers, &Options::default());
    assert_eq!((exact.samples, exact.rms_standard_error), (0, 0.0));
    for (i, normal) in normals.iter().enumerate().filter(|(_, normal)| normal.y > 0.95) {
        assert!((f64::from(exact.radiance.at(i).x) - 0.9025 * normal.y).abs() < 1e-5);
    }
    // Half of the light, seen through a closed form that the unit tests check by quadrature, from samples alone: the
    // blocker hides exactly what the smaller light would add.
    let cover = SphereLight { center: Vec3::Y * 0.5, radius: 0.4, radiance: Vec3::ONE };
    let small = run(&scene(vec![], black.clone(), vec![cover]), &receivers, &Options::default());
    let ring = scene(vec![ball(Vec3::Y * 0.03, 0.024)], black.clone(), vec![wide]);
    let options = Options { samples: 4096, ..Options::default() };
    let difference = |i| f64::from(exact.radiance.at(i).x) - f64::from(small.radiance.at(i).x);
    assert_agrees(&run(&ring, &receivers, &options), difference, 2e-3, 1e-4);

    let around = SphereLight { center: Vec3::new(0.2, 0.1, 0.0), radius: 3.0, radiance: Vec3::ONE };
    let estimate = run(&scene(far(), black, vec![around]), &receivers, &options);
    assert_agrees(&estimate, |_| 1.0, 1e-3, 1e-6);
}

#[test]
fn a_sun_behind_a_smaller_sphere_is_a_ring() {
    for (angular_radius, sine) in [(0.2_f32, 0.1_f32), (0.004_65, 0.003)] {
        let sun = Sun { direction: Vec3::Y, angular_radius, radiance: Vec3::splat(1.0 / angular_radius.powi(2)) };
        let environment = Environment { sun: Some(sun), ..Environment::constant(Vec3::ZERO) };
        let scene = scene(vec![ball(Vec3::Y * 10.0, 10.0 * sine)], environment, vec![]);
        let (receivers, normals) = at_the_origin(1.2, 100);
        let ring = f64::from(angular_radius).sin().powi(2) - f64::from(sine).powi(2);
        let expected = |i: usize| ring * normals[i].y / f64::from(angular_radius).powi(2);
        let options = Options { samples: 8192, ..Options::default() };
        assert_agrees(&run(&scene, &receivers, &options), expected, 1e-3, 2e-4);
    }
}

#[test]
fn a_map_is_sampled_by_both_techniques_without_bias() {
    // A bright cap of 40 degrees about the zenith, a dim, even a negative remainder, and a ball that hides 20 degrees in
    // the middle of the cap; both sampling techniques and the control variate have to agree with the closed form.
    let sine = 20_f64.to_radians().sin();
    for (bright, dim) in [(3.0, 1.0), (50.0, 0.1), (1.0, 20.0), (2.0, -0.5)] {
        let texels = (0..90 * 45).map(|i| Vec3::splat(if i / 90 < 10 { bright } else { dim })).collect();
        let environment = Environment::map(EnvironmentMap::new(90, 45, texels).unwrap());
        let mut scene = scene(vec![ball(Vec3::Y * 5.0, (5.0 * sine) as f32)], environment, vec![]);
        let (receivers, normals) = at_the_origin(0.85, 100);
        let cap = 40_f64.to_radians().sin().powi(2);
        let (bright, dim) = (f64::from(bright), f64::from(dim));
        // The cap lies above every horizon: its irradiance over π is sin²θ cos γ, and the rest adds up to the whole.
        let expected = |i: usize| dim + (bright - dim) * cap * normals[i].y - bright * sine * sine * normals[i].y;
        let options = Options { samples: 4096, ..Options::default() };
        let error = 1e-3 * bright.abs().max(dim.abs());
        let seen_from_inside = normals.iter().all(|n| n.y > 50_f64.to_radians().cos());
        assert!(seen_from_inside);
        assert_agrees(&run(&scene, &receivers, &options), expected, error, 1e-4 * (bright.abs() + dim.abs()));

        scene.objects.clear();
        let unshadowed = Options { transport: Transport::Unshadowed, ..options };
        let estimate = run(&scene, &receivers, &unshadowed);
        assert_eq!(estimate.rays, 0);
        for (i, normal) in normals.iter().enumerate() {
            let error = f64::from(estimate.radiance.at(i).x) - (dim + (bright - dim) * cap * normal.y);
            assert!(error.abs() < 2e-5 * (bright.abs() + dim.abs()), "{error}");
        }
    }
}
