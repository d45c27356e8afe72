//! Glossy lobes before spheres, boxes and own meshes, against the truth.

use crate::{built_scenes::bounded, common::shaded};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame, Material, Motion, Object, Pose, ReceiverBuffer, Reflectance, Scene, Sphere, SphereLight,
    SphereSet, builtin,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
    progress::Silent,
};
use halfshade_strategies::Mask;
use halfshade_truth::{Options, Tracer, estimate};

/// Root of the mean square error over the mean unshadowed radiance.
fn errors<const N: usize>(
    scene: &Scene,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
    settings: [&str; N],
) -> [f32; N] {
    let options = Options { samples: 256, ..Options::default() };
    let truth = estimate(&Tracer::new(frame), receivers.view(), &options, &Silent);
    let count = receivers.len() as f32;
    settings.map(|settings| {
        let found = shaded(&Mask, scene, frame, receivers, settings);
        let square = |i: usize| (found.at(i) - truth.radiance.at(i)).length_squared() / 3.0;
        let squares: f32 = (0..receivers.len()).map(square).sum();
        (squares / count).sqrt() / (truth.unshadowed.iter().sum::<f32>() / count)
    })
}

/// A slab that mirrors without a diffuse part, under balls that are their spheres.
fn scene(environment: Environment, exponent: f32) -> Scene {
    let reflectance = Reflectance::ModifiedPhong { specular: Vec3::ONE, exponent };
    let material = Material { reflectance, ..Material::new(Vec3::ZERO) };
    let ground = Object::new("ground", shapes::slab(Vec3::new(2.0, 0.1, 2.0), [24, 24]))
        .material(material.clone())
        .pose(Pose::from_translation(Vec3::new(0.0, -0.1, 0.0)));
    let ball = |center: Vec3, scale: f32| {
        let spheres = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
        let ball = Object::new("ball", shapes::sphere(16)).spheres(spheres).material(material.clone());
        ball.pose(Pose { scale, ..Pose::from_translation(center) })
    };
    let balls = [(Vec3::new(0.0, 0.7, 0.0), 0.5), (Vec3::new(0.9, 0.4, 0.5), 0.3), (Vec3::new(-0.8, 0.5, -0.6), 0.4)];
    let mut objects = vec![ground];
    objects.extend(balls.map(|(center, scale)| ball(center, scale)));
    let mut scene = Scene::at_rest("gloss", objects, environment);
    scene.camera.eye = Vec3::new(0.5, 2.5, 4.0);
    scene
}

/// Smooth, and in colour.
fn map() -> Environment {
    let texel = |i: usize| {
        let turn = std::f32::consts::TAU * (i % 128) as f32 / 128.0;
        Vec3::new(1.0 + turn.cos(), 1.5, 1.0 - (2.0 * turn).sin()) * (2.0 - (i / 128) as f32 / 64.0)
    };
    let map = EnvironmentMap::new(128, 64, (0..128 * 64).map(texel).collect()).unwrap();
    Environment { base: DistantLight::Map(map.into()), sun: None }
}

/// A sun of 10 degrees.
fn sun() -> Environment {
    let direction = Vec3::new(0.3, 0.6, -0.5).normalize();
    let sun = Sun { direction, angular_radius: 0.17, radiance: Vec3::splat(20.0) };
    Environment { base: DistantLight::Constant(Vec3::ZERO), sun: Some(sun) }
}

#[test]
fn lobes_of_every_sharpness_are_shadowed() {
    let lamp = SphereLight { center: Vec3::new(1.0, 3.0, -1.5), radius: 0.6, radiance: Vec3::splat(20.0) };
    let mut over = Vec::new();
    for (name, environment, exponents, bounds) in [
        ("sky", Environment::constant(Vec3::ONE), &[0.0, 40.0][..], [0.06, 0.05]),
        ("map", map(), &[40.0, 1e5], [0.07, 0.06]),
        ("sun", sun(), &[40.0, 1e5], [0.3, 0.2]),
        ("lamp", Environment::constant(Vec3::ZERO), &[0.0, 40.0], [0.45, 0.3]),
    ] {
        for &exponent in exponents {
            let mut scene = scene(environment.clone(), exponent);
            if name == "lamp" {
                scene.lights = vec![(lamp, Motion::Still(Pose::IDENTITY))];
            }
            let frame = scene.frame(0);
            let all = ReceiverBuffer::vertices(&frame);
            let some: Vec<u32> = (0..all.len() as u32).step_by(9).collect();
            let receivers = ReceiverBuffer::gathered(all.view(), &some);
            let errors = errors(&scene, &frame, &receivers, ["directions=64", "directions=256"]);
            if errors.iter().zip(bounds).any(|(error, bound)| error.is_nan() || *error > bound) {
                over.push((name, exponent, errors));
            }
        }
    }
    assert!(over.is_empty(), "{over:?}");
}

/// The glossy ball of a built-in scene errs about as much as it does without gloss: by its spheres.
#[test]
fn a_built_in_scene_shines() {
    let mut scene = builtin::scene("bowling").unwrap();
    // Few spheres are built in a second, and err alike with gloss and without.
    scene.objects.iter_mut().for_each(|object| object.sphere_count = object.sphere_count.min(10));
    let scene = bounded(scene);
    let frame = scene.frame(30);
    let all = ReceiverBuffer::vertices(&frame);
    let is_glossy = |object: u32| scene.objects[object as usize].material.reflectance.is_glossy();
    let glossy: Vec<u32> = (0..all.len() as u32).filter(|&i| is_glossy(all.view().object[i as usize])).collect();
    let some: Vec<u32> = glossy.iter().copied().step_by(glossy.len().div_ceil(400)).collect();
    let error = |scene: &Scene| {
        let frame = scene.frame(30);
        let receivers = ReceiverBuffer::gathered(ReceiverBuffer::vertices(&frame).view(), &some);
        let [error] = errors(scene, &frame, &receivers, ["directions=128"]);
        error
    };
    let mut dull = scene.clone();
    dull.objects.iter_mut().for_each(|object| object.material.reflectance = Reflectance::Lambert);
    let (glossy, dull) = (error(&scene), error(&dull));
    assert!(glossy < 1.3 * dull + 0.01, "{glossy}, without gloss {dull}");
}
