//! Receivers that move through a scene that stands still.

use crate::{
    common::{baked, shade},
    prt::scenes::{in_batches, limited_light},
};
use glam::{Quat, Vec3};
use halfshade_scene::{Environment, Mesh, Motion, Object, Pose, ReceiverBuffer, Scene, builtin::shapes};
use halfshade_sh::{basis, zonal};
use halfshade_strategies::{Prt, Unshadowed};
use std::f64::consts::PI;

/// A small ball that rises through a scene of static objects.
fn with_ball(static_objects: Vec<Object>, environment: Environment) -> Scene {
    let at = |height: f32| Pose { scale: 0.05, ..Pose::from_translation(Vec3::new(0.4, height, 0.0)) };
    let ball = Object::new("ball", shapes::sphere(8)).motion(Motion::Keyframes(vec![(0.0, at(0.3)), (1.0, at(0.9))]));
    let objects = static_objects.into_iter().chain([ball]).collect();
    Scene { frame_count: 11, frames_per_sec: 10.0, ..Scene::at_rest("ball", objects, environment) }
}

/// A wall without end, which faces +X.
fn wall(albedo: f32) -> Object {
    let far = 1e4;
    let mesh = Mesh {
        positions: [(-far, -far), (far, -far), (far, far), (-far, far)].map(|(y, z)| Vec3::new(0.0, y, z)).to_vec(),
        normals: vec![Vec3::X; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    Object::new("wall", mesh).albedo(Vec3::splat(albedo))
}

/// Normals and radiance of the ball's vertices at a frame.
fn ball(scene: &Scene, index: usize, settings: &str) -> Vec<(Vec3, Vec3)> {
    let frame = scene.frame(index);
    let receivers = ReceiverBuffer::vertices(&frame);
    let radiance = shade(baked(&Prt::default(), scene, settings).as_mut(), &frame, &receivers);
    let last = scene.objects.len() as u32 - 1;
    let on_ball = (0..receivers.len()).filter(|&i| receivers.view().object[i] == last);
    on_ball.map(|i| (receivers.view().normal_at(i), radiance.at(i))).collect()
}

/// Nothing hides anything worth mentioning: light of as many bands as the volume has is exact, wherever the ball is.
#[test]
fn an_open_sky_is_exact() {
    let speck = Object::new("speck", shapes::plane(1)).pose(Pose { scale: 1e-4, ..Pose::IDENTITY });
    let scene = with_ball(vec![speck], limited_light(3, 31));
    let frame = scene.frame(4);
    let receivers = ReceiverBuffer::vertices(&frame);
    let exact = crate::common::shaded(&Unshadowed, &scene, &frame, &receivers, "normals=64");
    for settings in ["moving=volume,directions=64", "moving=volume,transfer=unshadowed,bands=3,volume-steps=1"] {
        let found = ball(&scene, 4, settings);
        for (i, (_, radiance)) in found.iter().enumerate() {
            let exact = exact.at(receivers.len() - found.len() + i);
            assert!(
                (*radiance - exact).abs().max_element() < 5e-3 * exact.max_element(),
                "{settings}: {radiance} {exact}"
            );
        }
    }
}

/// A wall hides half of the sky. Three bands of it have a closed form, near the share of the sky that a normal sees.
#[test]
fn a_wall_hides_half_of_the_sky() {
    // ∫ over x > 0: zonal coefficients about +X, by the midpoint rule.
    let steps = 20_000;
    let half: Vec<f64> = (0..3)
        .map(|l| {
            let step = |k: usize| {
                let height = (k as f64 + 0.5) / steps as f64;
                2.0 * PI / steps as f64
                    * basis::evaluate(3, [(1.0 - height * height).sqrt(), 0.0, height])[basis::index(l, 0)]
            };
            (0..steps).map(step).sum()
        })
        .collect();
    let sky = zonal::rotate_to_axis(&half, [1.0, 0.0, 0.0]);
    let cosine: Vec<f64> = zonal::clamped_cosine(3).into_iter().map(|value| value / PI).collect();
    for (albedo, bounces) in [(0.0, 0), (0.5, 1)] {
        let scene = Scene { bounces, ..with_ball(vec![wall(albedo)], Environment::constant(Vec3::ONE)) };
        let reflected = f64::from(albedo);
        for (normal, radiance) in ball(&scene, 7, "moving=volume,volume-steps=3,directions=4096") {
            let seen = basis::dot(&sky, &zonal::rotate_to_axis(&cosine, normal.as_dvec3().normalize().to_array()));
            let expected = seen + reflected * (1.0 - seen);
            assert!((f64::from(radiance.x) - expected).abs() < 3e-3, "{normal}: {radiance} {expected}");
            let whole = 0.5 + 0.5 * f64::from(normal.x);
            assert!((seen - whole).abs() < 0.04, "{normal}: {seen} {whole}");
        }
    }
}

/// The scene as a whole turned, lit by turned light, and the ball at its place in it.
#[test]
fn everything_turned_looks_the_same() {
    let block = Object::new("block", shapes::box_mesh(2)).pose(Pose { scale: 0.2, ..Pose::IDENTITY });
    let scene = with_ball(vec![wall(0.5), block], limited_light(4, 32));
    let mut baked = baked(&Prt::default(), &scene, "moving=volume,directions=64,volume-steps=4");
    let frame = scene.frame(6);
    let before = shade(baked.as_mut(), &frame, &ReceiverBuffer::vertices(&frame));
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1);
    let outer = Pose { scale: 2.0, rotation: turn, translation: Vec3::new(3.0, -2.0, 5.0) };
    let mut turned = frame.clone();
    turned.world_from_object.iter_mut().for_each(|pose| *pose = pose.then(&outer));
    turned.world_from_environment = turn;
    let after = shade(baked.as_mut(), &turned, &ReceiverBuffer::vertices(&turned));
    for i in 0..before.len() {
        assert!((before.at(i) - after.at(i)).abs().max_element() < 1e-4 * before.at(i).max_element().max(1.0));
    }
}

/// Points within a solid take light from outside: beside a white block under a white sky nothing is as dark as within.
#[test]
fn solids_are_not_dark_beside_their_walls() {
    let block = Object::new("block", shapes::box_mesh(3))
        .albedo(Vec3::ONE)
        .pose(Pose { scale: 0.3, ..Pose::from_translation(Vec3::new(0.04, 0.6, 0.0)) });
    let scene = Scene { bounces: 1, ..with_ball(vec![block], Environment::constant(Vec3::ONE)) };
    let settings = "moving=volume,directions=256,volume-steps=8";
    let details = baked(&Prt::default(), &scene, settings).details();
    let inside = details.iter().find(|detail| detail.name == "points of it within solids").unwrap().values[0];
    assert!(inside > 0.0, "{details:?}");
    for (normal, radiance) in ball(&scene, 5, settings) {
        assert!(
            radiance.is_finite() && radiance.min_element() > 0.45 && radiance.max_element() < 1.1,
            "{normal}: {radiance}"
        );
    }
}

/// Vectors of all that stands still are the same as if nothing moved: the ball's shadow isn't there.
#[test]
fn what_stands_still_is_as_without_movers() {
    let ground = Object::new("ground", shapes::plane(4));
    let scene = with_ball(vec![ground.clone()], limited_light(4, 33));
    let alone = Scene::at_rest("ground", vec![ground], scene.environment.clone());
    let settings = "moving=volume,directions=64";
    let frame = scene.frame(3);
    let found = shade(baked(&Prt::default(), &scene, settings).as_mut(), &frame, &ReceiverBuffer::vertices(&frame));
    let (_, exact) = super::scenes::vertices(&alone, "directions=64");
    assert!((0..exact.len()).all(|i| found.at(i) == exact.at(i)));
}

#[test]
fn batches_change_no_bit() {
    let scene = with_ball(vec![wall(0.5)], limited_light(3, 34));
    let frame = scene.frame(3);
    let receivers = ReceiverBuffer::vertices(&frame);
    for settings in ["moving=volume,directions=16", "moving=volume,directions=16,compression=vq,clusters=3"] {
        let mut baked = baked(&Prt::default(), &scene, settings);
        let whole = shade(baked.as_mut(), &frame, &receivers);
        let prepared = baked.prepare(&frame).unwrap();
        for size in [1, 3, 8, 13] {
            assert_eq!(in_batches(&*prepared, &receivers, size).channels, whole.channels, "{settings} {size}");
        }
    }
}

/// In the open, a torus that tumbles is shaded as one that stands as it does at that frame, light of few bands being what both know.
#[test]
fn a_body_hides_light_from_itself() {
    let speck = Object::new("speck", shapes::plane(1)).pose(Pose { scale: 1e-4, ..Pose::IDENTITY });
    let turn = |angle: f32| Pose {
        rotation: Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), angle),
        ..Pose::from_translation(Vec3::Y)
    };
    let torus = |motion: Motion| Object::new("torus", shapes::torus(0.8, 0.4, 32, 16)).motion(motion);
    let tumbling = torus(Motion::Keyframes(vec![(0.0, turn(0.0)), (1.0, turn(2.0))]));
    let scene = Scene {
        frame_count: 3,
        frames_per_sec: 1.0,
        ..Scene::at_rest("tumbling", vec![speck, tumbling], limited_light(3, 35))
    };
    let frame = scene.frame(1);
    let receivers = ReceiverBuffer::vertices(&frame);
    let shaded = |scene: &Scene, settings: &str| {
        shade(baked(&Prt::default(), scene, settings).as_mut(), &scene.frame(1), &receivers)
    };
    let found = shaded(&scene, "moving=volume,directions=512");
    let still = Scene { objects: vec![scene.objects[0].clone(), torus(Motion::Still(turn(2.0)))], ..scene.clone() };
    let exact = shaded(&still, "transfer=shadowed,bands=3,directions=512");
    let open = shaded(&still, "transfer=unshadowed,bands=3");
    let difference = |other: &halfshade_scene::RadianceBuffer| {
        // The torus's shadow on the speck isn't known.
        let on_torus = (0..receivers.len()).filter(|&i| receivers.view().object[i] == 1);
        on_torus.map(|i| (other.at(i) - exact.at(i)).abs().max_element()).fold(0.0, f32::max)
    };
    assert!(difference(&found) < 0.1 * difference(&open), "{} {}", difference(&found), difference(&open));
}
