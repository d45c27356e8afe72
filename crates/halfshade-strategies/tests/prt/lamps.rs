//! Local lights against closed forms, the sky and the sun.

use crate::{
    common::{baked, shade},
    prt::scenes::{in_batches, limited_light, torus_over_ground, vertices},
};
use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, SphereLight,
    builtin::shapes, light::Sun, progress::Silent,
};
use halfshade_strategies::Prt;
use halfshade_strategy::{Strategy, StrategyError};
use std::f32::consts::PI;

const DARK: Environment = Environment::constant(Vec3::ZERO);

fn lamp(center: Vec3, radius: f32, radiance: Vec3) -> (SphereLight, Motion) {
    (SphereLight { center, radius, radiance }, Motion::Still(Pose::IDENTITY))
}

/// A torus over the ground, and a lamp so far above them that looks as large from everywhere.
fn with_lamp(distance: f32) -> Scene {
    let center = distance * Vec3::new(0.48, 0.8, 0.36);
    let lights = vec![lamp(center, 0.2 * distance, Vec3::new(3.0, 2.0, 1.0))];
    Scene { lights, ..torus_over_ground(DARK, [Vec3::new(0.8, 0.4, 0.3), Vec3::ONE]) }
}

/// Root mean square of differences over that of `expected`.
fn difference(found: &RadianceBuffer, expected: &RadianceBuffer) -> f32 {
    let squares = |value: &dyn Fn(usize) -> Vec3| (0..found.len()).map(|i| value(i).length_squared()).sum::<f32>();
    (squares(&|i| found.at(i) - expected.at(i)) / squares(&|i| expected.at(i))).sqrt()
}

/// Eight bands of a cosine are nearly all of it: about a hundredth of a small light is missed.
#[test]
fn unshadowed_light_is_the_closed_form() {
    for distance in [2.0, 5.0, 40.0] {
        let scene = with_lamp(distance);
        let (receivers, found) = vertices(&scene, "transfer=unshadowed,bands=8");
        let view = receivers.view();
        let mut exact = RadianceBuffer::zeros(receivers.len());
        for i in 0..receivers.len() {
            let irradiance = scene.lights[0].0.irradiance(view.position_at(i), view.normal_at(i));
            exact.view_mut().set(i, view.albedo_at(i) * irradiance / PI);
        }
        let error = difference(&found, &exact);
        assert!(error < 0.015, "{distance}: {error}");
    }
}

/// Between points light errs less the more of them there are, and the farther away it is: by the square of step over distance.
#[test]
fn light_between_points_converges() {
    let mut before: Option<Vec<f32>> = None;
    for distance in [2.5, 5.0, 10.0] {
        let scene = with_lamp(distance);
        let (_, exact) = vertices(&scene, "directions=64");
        let errors = [2, 4, 8, 16].map(|steps| {
            let (_, found) = vertices(&scene, &format!("directions=64,lamp-steps={steps}"));
            difference(&found, &exact)
        });
        assert!(errors.is_sorted_by(|more, less| *less < 0.5 * more), "{distance}: {errors:?}");
        if let Some(before) = before {
            let falls = errors.iter().zip(&before).all(|(now, before)| *now < 0.5 * before);
            assert!(falls, "{distance}: {errors:?} {before:?}");
        }
        before = Some(errors.to_vec());
    }
}

/// Within a light everything shines alike: a sky, with its shadows, bounces and gloss, however transfer is stored and light is known.
#[test]
fn a_light_around_everything_is_a_sky() {
    let radiance = Vec3::new(1.0, 2.0, 3.0);
    let albedos = [Vec3::new(0.8, 0.4, 0.3), Vec3::splat(0.5)];
    for (bounces, gloss, settings) in [
        (0, false, "directions=64"),
        (2, false, "directions=64,lamp-steps=3"),
        (1, false, "bands=3,directions=64,compression=cpca,clusters=4,components=5"),
        (1, true, "bands=3,directions=64"),
        (0, true, "bands=3,directions=64,lamp-steps=2,window=hann"),
    ] {
        let sky = Scene { bounces, ..torus_over_ground(Environment::constant(radiance), albedos) };
        let mut sky = sky;
        if gloss {
            let specular = Vec3::splat(0.2);
            sky.objects[0].material.reflectance = Reflectance::ModifiedPhong { specular, exponent: 3.0 };
            sky.camera.eye = Vec3::new(1.5, 3.0, 2.5);
        }
        let around = Scene { environment: DARK, lights: vec![lamp(Vec3::ONE, 50.0, radiance)], ..sky.clone() };
        let ((receivers, expected), (_, found)) = (vertices(&sky, settings), vertices(&around, settings));
        for i in 0..receivers.len() {
            let error = (found.at(i) - expected.at(i)).abs().max_element();
            assert!(error < 2e-5, "{settings} {i}: {} {}", found.at(i), expected.at(i));
        }
    }
}

/// Far away, a light is a sun.
#[test]
fn a_distant_light_is_a_sun() {
    let (direction, angular_radius, radiance) = (Vec3::new(0.48, 0.8, 0.36), 0.2_f32, Vec3::new(9.0, 6.0, 3.0));
    let sun = Sun { direction, angular_radius, radiance };
    let environment = Environment { sun: Some(sun), ..DARK };
    let sunlit = Scene { bounces: 1, ..torus_over_ground(environment, [Vec3::splat(0.5); 2]) };
    let lights = vec![lamp(1e4 * direction, 1e4 * angular_radius.sin(), radiance)];
    let lamplit = Scene { environment: DARK, lights, ..sunlit.clone() };
    let ((_, expected), (_, found)) = (vertices(&sunlit, "directions=64"), vertices(&lamplit, "directions=64"));
    let error = difference(&found, &expected);
    assert!(error < 1e-3, "{error}");
}

/// Lights move with the scene, and light from infinitely far is beside them.
#[test]
fn everything_moved_together_looks_the_same() {
    let environment = limited_light(3, 41);
    let scene = Scene { environment, ..with_lamp(2.5) };
    let frame = scene.frame(0);
    let mut baked = baked(&Prt::default(), &scene, "directions=64");
    let receivers = ReceiverBuffer::vertices(&frame);
    let before = shade(baked.as_mut(), &frame, &receivers);
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1);
    let outer = Pose { scale: 2.0, rotation: turn, translation: Vec3::new(3.0, -2.0, 5.0) };
    let mut moved = frame.clone();
    moved.world_from_object.iter_mut().for_each(|pose| *pose = pose.then(&outer));
    moved.lights.iter_mut().for_each(|light| *light = light.moved(&outer));
    moved.world_from_environment = turn;
    let after = shade(baked.as_mut(), &moved, &ReceiverBuffer::vertices(&moved));
    assert!(difference(&after, &before) < 1e-5);
    let prepared = baked.prepare(&frame).unwrap();
    for size in [1, 3, 8, 13] {
        assert_eq!(in_batches(&*prepared, &receivers, size).channels, before.channels, "{size}");
    }
}

/// A ball that moves through the volume of a light that is around everything sees a sky.
#[test]
fn bodies_that_move_have_local_light() {
    let at = |height: f32| Pose { scale: 0.05, ..Pose::from_translation(Vec3::new(0.4, height, 0.0)) };
    let ball = Object::new("ball", shapes::sphere(8)).motion(Motion::Keyframes(vec![(0.0, at(0.3)), (1.0, at(0.9))]));
    let objects = vec![Object::new("ground", shapes::plane(4)).albedo(Vec3::new(0.2, 0.9, 0.5)), ball];
    let sky = Scene::at_rest("ball", objects, Environment::constant(Vec3::ONE));
    let sky = Scene { frame_count: 2, frames_per_sec: 1.0, bounces: 1, ..sky };
    let around = Scene { environment: DARK, lights: vec![lamp(Vec3::ONE, 50.0, Vec3::ONE)], ..sky.clone() };
    let shaded = |scene: &Scene| {
        let frame = scene.frame(1);
        let settings = "moving=volume,directions=64,volume-steps=3";
        shade(baked(&Prt::default(), scene, settings).as_mut(), &frame, &ReceiverBuffer::vertices(&frame))
    };
    assert!(difference(&shaded(&around), &shaded(&sky)) < 1e-5);
}

#[test]
fn light_that_is_fitted_is_refused() {
    let strategy = Prt::default();
    for settings in ["light=zh3", "light=guessed-zh3", "window=nonnegative"] {
        let params = strategy.info().parse(&format!("transfer=unshadowed,{settings}")).unwrap();
        let error = strategy.bake(&with_lamp(3.0), &params, &Silent).err().expect("refused");
        assert!(matches!(&error, StrategyError::Unsupported(reason) if reason.contains("take light=sh")), "{error}");
    }
}
