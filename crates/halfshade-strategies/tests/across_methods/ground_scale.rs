//! Rays from surfaces find the same nearby whatever else the scene holds.

use crate::common::shaded;
use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment, Mesh, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, SphereLight, builtin::shapes,
};
use halfshade_strategies::{RayTraced, ShadowField};
use halfshade_strategy::Strategy;
use std::f64::consts::TAU;

fn object(mesh: Mesh, pose: Pose) -> Object {
    Object::new("object", mesh).cluster_count(1).pose(pose)
}

fn shade(strategy: &dyn Strategy, settings: &str, scene: &Scene, receivers: &ReceiverBuffer) -> RadianceBuffer {
    shaded(strategy, scene, &scene.frame(0), receivers, settings)
}

/// The open part of the sky at the foot of a wall of half width `w` and height `h`, at distance `d` in front of its middle: 1
/// less the form factor of a rectangle at right angles.
fn open(w: f64, h: f64, d: f64) -> f64 {
    let far = h.hypot(d);
    1.0 - 2.0 / TAU * ((w / d).atan() - d / far * (w / far).atan())
}

fn box_on_ground(scale: f32) -> Scene {
    let ground = object(shapes::plane(2), Pose { scale, ..Pose::IDENTITY });
    let block = object(shapes::box_mesh(3), Pose { scale: 0.1, ..Pose::from_translation(Vec3::new(0.0, 0.1, 0.0)) });
    Scene::at_rest("box on ground", vec![ground, block], Environment::constant(Vec3::ONE))
}

#[test]
fn ray_traced_contact_shadows_have_their_closed_form_on_any_ground() {
    let distances = [1e-5f32, 1e-3, 0.02, 0.1];
    let mut receivers = ReceiverBuffer::default();
    distances.iter().for_each(|d| receivers.push(Vec3::new(0.1 + d, 0.0, 0.0), Vec3::Y, Vec3::ONE, 0));
    // Walls see half the sky down to the ground.
    let heights = [0.0, 1e-5, 1e-3, 0.1];
    heights.iter().for_each(|&h| receivers.push(Vec3::new(0.1, h, 0.03), Vec3::X, Vec3::ONE, 1));
    for scale in [3.0, 1e3, 1e5, 1e7] {
        let found = shade(&RayTraced, "unfiltered,samples=4096", &box_on_ground(scale), &receivers);
        for (i, &value) in found.channels[0].iter().enumerate() {
            let expected = distances.get(i).map_or(0.5, |&d| open(0.1, 0.2, f64::from(0.1 + d) - f64::from(0.1f32)));
            // A small ground ends within sight of its walls.
            let tolerance = if scale < 10.0 && i >= 4 { 0.03 } else { 6e-3 };
            assert!((f64::from(value) - expected).abs() < tolerance, "{scale}, {i}: {value} instead of {expected}");
        }
    }
}

/// A convex object under the whole sky, alone but for a small one far away.
fn tilted_box(far: f32) -> Scene {
    let rotation = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.5);
    let here = object(shapes::box_mesh(3), Pose { rotation, ..Pose::IDENTITY });
    let there = object(shapes::box_mesh(1), Pose::from_translation(far * Vec3::new(0.6, 0.48, 0.64)));
    Scene::at_rest("tilted box", vec![here, there], Environment::constant(Vec3::ONE))
}

#[test]
fn surfaces_do_not_shadow_themselves_in_large_scenes() {
    let whole_sky_is_seen = |strategy: &dyn Strategy, settings: &str| {
        for far in [1e4, 1e5] {
            let scene = tilted_box(far);
            let receivers = ReceiverBuffer::vertices(&scene.frame(0));
            let found = shade(strategy, settings, &scene, &receivers);
            for (i, value) in found.channels[0].iter().enumerate().take(scene.objects[0].mesh.positions.len()) {
                assert!((value - 1.0).abs() < 5e-3, "{settings}, {far}, {i}: {value} instead of 1");
            }
        }
    };
    whole_sky_is_seen(&ShadowField::default(), "sampling=together,shells=4,resolution=4,map=32");
    whole_sky_is_seen(&RayTraced, "plain,samples=64,sampling=cosine");
}

/// A lamp that touches a wall lights it: rays to it end before what lies behind.
#[test]
fn lamps_near_walls_are_seen_on_any_ground() {
    let mut receivers = ReceiverBuffer::default();
    [0.02f32, 0.3].iter().for_each(|d| receivers.push(Vec3::new(0.1 + d, 0.0, 0.0), Vec3::Y, Vec3::ONE, 0));
    let at = |scale| {
        let mut scene = box_on_ground(scale);
        scene.environment = Environment::constant(Vec3::ZERO);
        let light = SphereLight { center: Vec3::new(0.12, 0.05, 0.0), radius: 0.02, radiance: Vec3::ONE };
        scene.lights.push((light, Motion::Still(Pose::IDENTITY)));
        shade(&RayTraced, "unfiltered,samples=256", &scene, &receivers)
    };
    let small = at(3.0);
    for scale in [1e5, 1e7] {
        let large = at(scale);
        for (a, b) in small.channels[0].iter().zip(&large.channels[0]) {
            assert!((a - b).abs() < 0.01 * a.abs() && *a > 0.0, "{scale}: {b} instead of {a}");
        }
    }
}
