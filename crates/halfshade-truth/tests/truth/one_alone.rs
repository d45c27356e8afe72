//! Work that a scene doesn't require isn't done: here one object, light or channel alone requires it.

use crate::scenes::{object, run, scene, square};
use glam::{Vec2, Vec3};
use halfshade_scene::{
    Environment, Mesh, Object, Pose, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, SphereLight, Texture,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
    mesh::AlphaMask,
};
use halfshade_truth::{Estimate, Options};
use std::sync::Arc;

const RED: Vec3 = Vec3::new(0.9, 0.2, 0.05);
const BLUE: Vec3 = Vec3::new(0.0, 0.0, 1.0);

fn options(bounces: usize) -> Options {
    Options { samples: 64, bounces, ..Options::default() }
}

/// Grey ground, and two grey balls above it.
fn grey(environment: Environment, lights: Vec<SphereLight>) -> Scene {
    let ball =
        |x: f32| object(shapes::sphere(5), Pose { scale: 0.5, ..Pose::from_translation(Vec3::new(x, 0.7, 0.1)) });
    let ground = object(square(4), Pose { scale: 3.0, ..Pose::IDENTITY });
    let mut scene = scene(vec![ground, ball(-0.6), ball(0.6)], environment, lights);
    scene.objects.iter_mut().for_each(|object| object.material.albedo = Vec3::splat(0.8));
    scene.camera.eye = Vec3::new(0.5, 4.0, 3.0);
    scene
}

fn sky() -> Environment {
    Environment::constant(Vec3::ONE)
}

fn dark() -> Environment {
    Environment::constant(Vec3::ZERO)
}

fn map(texel: impl Fn(usize) -> Vec3) -> Environment {
    Environment::map(EnvironmentMap::new(16, 8, (0..128).map(texel).collect()).unwrap())
}

fn sun(radiance: Vec3) -> Option<Sun> {
    Some(Sun { direction: Vec3::new(0.6, 0.8, 0.0), angular_radius: 0.1, radiance })
}

fn lamp(x: f32, radiance: Vec3) -> SphereLight {
    SphereLight { center: Vec3::new(x, 2.5, 0.4), radius: 0.3, radiance }
}

fn shiny(object: &mut Object) {
    object.material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.15), exponent: 6.0 };
}

fn receivers(scene: &Scene) -> ReceiverBuffer {
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    ReceiverBuffer::gathered(all.view(), &(0..all.len() as u32).step_by(3).collect::<Vec<_>>())
}

fn found(scene: &Scene, bounces: usize) -> Estimate {
    run(scene, &receivers(scene), &options(bounces))
}

/// Whether values agree to within their errors, as far as Student's distribution with 15 degrees of freedom reaches;
/// nothing that is dark in one alone is a matter of errors.
fn assert_agrees(a: &[f32], b: &[f32], errors: [&[f32]; 2], place: &str) {
    let (mut sum, mut variance) = (0.0, 0.0);
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        let error = errors[0][i].hypot(errors[1][i]);
        assert!((a - b).abs() <= 9.0 * error + 2e-5 * (1.0 + b.abs()), "{place}, {i}: {a} {b}, error {error}");
        (sum, variance) = (sum + f64::from(a - b), variance + f64::from(error).powi(2));
    }
    assert!(sum.abs() <= 5.0 * variance.sqrt() + 2e-5 * a.len() as f64, "{place}: {sum}, error {}", variance.sqrt());
}

fn assert_same(a: &Estimate, b: &Estimate, place: &str) {
    for c in 0..3 {
        let errors = [a, b].map(|estimate| estimate.standard_error.channels[c].as_slice());
        assert_agrees(&a.radiance.channels[c], &b.radiance.channels[c], errors, &format!("{place}, channel {c}"));
    }
}

/// The scene with the values of one channel in all channels.
fn channel_of(scene: &Scene, channel: usize) -> Scene {
    let grey = |color: Vec3| Vec3::splat(color[channel]);
    let mut one = scene.clone();
    for object in &mut one.objects {
        object.material.albedo = grey(object.material.albedo);
        if let Reflectance::ModifiedPhong { specular, .. } = &mut object.material.reflectance {
            *specular = grey(*specular);
        }
        Arc::make_mut(&mut object.mesh).colors.iter_mut().for_each(|color| *color = grey(*color));
    }
    one.environment.base = match &one.environment.base {
        DistantLight::Constant(radiance) => DistantLight::Constant(grey(*radiance)),
        DistantLight::Map(map) => {
            let texels = map.texels().iter().map(|texel| grey(*texel)).collect();
            Environment::map(EnvironmentMap::new(map.width(), map.height(), texels).unwrap()).base
        }
    };
    if let Some(sun) = &mut one.environment.sun {
        sun.radiance = grey(sun.radiance);
    }
    one.lights.iter_mut().for_each(|(light, _)| light.radiance = grey(light.radiance));
    one
}

/// Light transport keeps channels apart: each is what it is in the grey scene that has this channel's values everywhere.
#[test]
fn every_channel_is_as_it_is_alone() {
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = grey(sky(), vec![]);
        change(&mut scene);
        scene
    };
    let vertex_colours = |object: &mut Object| {
        let mesh = Arc::make_mut(&mut object.mesh);
        mesh.colors = vec![Vec3::splat(0.7); mesh.positions.len()];
        mesh.colors.iter_mut().step_by(3).for_each(|color| *color = Vec3::new(0.2, 0.4, 1.0));
    };
    let lone_sun = Environment { sun: sun(30.0 * BLUE), ..dark() };
    let scenes = [
        ("one object's albedo", with(&|s| s.objects[2].material.albedo = RED)),
        ("one object's vertices", with(&|s| vertex_colours(&mut s.objects[2]))),
        ("one object reflects one channel", {
            with(&|s| {
                s.objects.iter_mut().for_each(|object| object.material.albedo = Vec3::ZERO);
                s.objects[0].material.albedo = 0.6 * BLUE;
            })
        }),
        ("one object's gloss", {
            with(&|s| {
                let reflectance = Reflectance::ModifiedPhong { specular: 0.1 * BLUE, exponent: 9.0 };
                s.objects[1].material.reflectance = reflectance;
            })
        }),
        ("sky", with(&|s| s.environment = Environment::constant(BLUE))),
        ("one texel", with(&|s| s.environment = map(|i| if i == 21 { 9.0 * RED } else { Vec3::ONE }))),
        ("one lit texel", with(&|s| s.environment = map(|i| if i == 21 { 9.0 * BLUE } else { Vec3::ZERO }))),
        ("sun", with(&|s| s.environment.sun = sun(20.0 * RED))),
        ("sun in the dark", grey(lone_sun, vec![])),
        ("one of two lamps", grey(sky(), vec![lamp(-1.0, Vec3::splat(5.0)), lamp(1.0, 8.0 * BLUE)])),
    ];
    for (name, scene) in &scenes {
        for bounces in [0, 2] {
            let all = found(scene, bounces);
            for channel in 0..3 {
                let alone = found(&channel_of(scene, channel), bounces);
                let errors = [&all, &alone].map(|estimate| estimate.standard_error.channels[channel].as_slice());
                let place = format!("{name}, {bounces} bounces, channel {channel}");
                assert_agrees(&all.radiance.channels[channel], &alone.radiance.channels[channel], errors, &place);
            }
        }
    }
}

/// A glossy object shines as if all did, and nobody else is changed by it but by what it reflects onto them.
#[test]
fn one_glossy_object_among_many() {
    let light = || Environment { sun: sun(Vec3::splat(20.0)), ..map(|i| Vec3::splat(1.0 + (i % 5) as f32)) };
    let dull = grey(light(), vec![lamp(-1.0, Vec3::splat(5.0))]);
    for number in 0..3 {
        let (mut one, mut all) = (dull.clone(), dull.clone());
        shiny(&mut one.objects[number]);
        all.objects.iter_mut().for_each(shiny);
        let [none, one, all] = [&dull, &one, &all].map(|scene| found(scene, 0));
        let of = |buffer: &RadianceBuffer, is_it: bool| -> Vec<f32> {
            let objects = receivers(&dull).object;
            let pairs = objects.iter().zip(&buffer.channels[1]);
            pairs.filter(|&(&object, _)| (object as usize == number) == is_it).map(|(_, &value)| value).collect()
        };
        for (other, is_it) in [(&all, true), (&none, false)] {
            let [a, b] = [&one, other].map(|estimate| of(&estimate.radiance, is_it));
            let errors = [&one, other].map(|estimate| of(&estimate.standard_error, is_it));
            assert_agrees(&a, &b, errors.each_ref().map(Vec::as_slice), &format!("object {number}, {is_it}"));
        }
        let gain: f32 = of(&one.radiance, true).iter().zip(of(&none.radiance, true)).map(|(a, b)| a - b).sum();
        assert!(gain > 0.01, "object {number} doesn't shine: {gain}");
    }
}

/// Lights add up, though each is sampled in its own way.
#[test]
fn one_light_of_its_kind() {
    let sun_alone = Environment { sun: sun(Vec3::splat(20.0)), ..dark() };
    let lamps = [lamp(-1.0, Vec3::splat(5.0)), SphereLight { radius: 20.0, ..lamp(0.0, RED) }];
    for is_shiny in [false, true] {
        for base in [sky(), map(|i| if i == 21 { 9.0 * RED } else { Vec3::ONE })] {
            let both = Environment { sun: sun_alone.sun, ..base.clone() };
            let mut scenes = [
                grey(both, lamps.to_vec()),
                grey(base, vec![]),
                grey(sun_alone.clone(), vec![]),
                grey(dark(), vec![lamps[0]]),
                grey(dark(), vec![lamps[1]]),
            ];
            if is_shiny {
                scenes.iter_mut().for_each(|scene| shiny(&mut scene.objects[1]));
            }
            for bounces in [0, 2] {
                let [together, parts @ ..] = scenes.each_ref().map(|scene| found(scene, bounces));
                for c in 0..3 {
                    let count = together.radiance.len();
                    let sum = |value: &dyn Fn(&Estimate, usize) -> f32| -> Vec<f32> {
                        (0..count).map(|i| parts.iter().map(|part| value(part, i)).sum()).collect()
                    };
                    let expected = sum(&|part, i| part.radiance.channels[c][i]);
                    let variance = sum(&|part, i| part.standard_error.channels[c][i].powi(2));
                    let error: Vec<f32> = variance.into_iter().map(f32::sqrt).collect();
                    let errors = [together.standard_error.channels[c].as_slice(), error.as_slice()];
                    let place = format!("shiny {is_shiny}, {bounces} bounces, channel {c}");
                    assert_agrees(&together.radiance.channels[c], &expected, errors, &place);
                }
            }
        }
    }
}

/// An object that is one hole among many that are whole is as none, and one that is whole behind its mask as without it.
#[test]
fn one_object_with_holes() {
    let masked = |alpha: f32| {
        let mesh = square(2);
        let texture = Texture::new(1, 1, vec![Vec3::splat(alpha)]).unwrap();
        let mesh = Mesh {
            texture_coordinates: mesh.positions.iter().map(|_| Vec3::splat(0.5)).collect(),
            masks: vec![AlphaMask { texture: Some(Arc::new(texture)), cutoff: 0.5 }],
            coverage: vec![Vec2::X; mesh.positions.len()],
            ..mesh
        };
        object(mesh, Pose::from_translation(1.6 * Vec3::Y))
    };
    let plain = grey(sky(), vec![lamp(-1.0, Vec3::splat(5.0))]);
    let of_plain = receivers(&plain);
    let with = |object: Object| {
        let mut scene = plain.clone();
        scene.objects.push(object);
        scene
    };
    let whole = object(square(2), Pose::from_translation(1.6 * Vec3::Y));
    for bounces in [0, 2] {
        let [none, hole, masked, whole] = [plain.clone(), with(masked(0.0)), with(masked(1.0)), with(whole.clone())]
            .map(|scene| run(&scene, &of_plain, &options(bounces)));
        assert_same(&hole, &none, "a hole");
        assert_same(&masked, &whole, "a whole");
        assert!(whole.radiance != none.radiance);
    }
}
