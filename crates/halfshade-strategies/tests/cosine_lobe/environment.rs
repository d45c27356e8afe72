//! Environments as cosine lobes against closed forms, against the ray-traced truth of the same spheres, and at the extremes.

use crate::common;
use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment, Object, RadianceBuffer, ReceiverBuffer, Reflectance, Scene, Sphere, SphereSet,
    builtin::shapes,
    light::{EnvironmentMap, Sun},
    progress::Silent,
    spheres::AdjustRule,
};
use halfshade_strategies::CosineLobe;
use halfshade_truth::{Geometry, Options, Tracer, Transport, estimate};

/// A ground without spheres, and an object of these.
fn scene(environment: Environment, spheres: &[Sphere]) -> Scene {
    let object = Object::new("object", shapes::plane(1)).cluster_count(1);
    let with_spheres = if spheres.is_empty() {
        object.clone()
    } else {
        object.clone().spheres(SphereSet { spheres: spheres.to_vec(), ..SphereSet::default() })
    };
    let mut scene = Scene::at_rest("environment", vec![object, with_spheres], environment);
    scene.camera.eye = Vec3::new(0.0, 2.0, 5.0);
    scene
}

fn shaded(scene: &Scene, settings: &str, receivers: &ReceiverBuffer) -> RadianceBuffer {
    common::shaded(&CosineLobe, scene, &scene.frame(0), receivers, settings)
}

/// A sky, darker towards the ground, a window of 30 by 45 degrees and a lamp of 11 degrees.
fn room() -> Environment {
    let (width, height) = (128, 64);
    let texels = (0..width * height).map(|i| {
        let (column, row) = (i % width, i / width);
        let sky = Vec3::new(0.5, 0.6, 0.8) * (1.0 - 0.8 * row as f32 / height as f32);
        let is_window = (20..31).contains(&column) && (12..28).contains(&row);
        let is_lamp = (80..84).contains(&column) && (10..14).contains(&row);
        let window = if is_window { Vec3::new(6.0, 5.5, 5.0) } else { Vec3::ZERO };
        sky + window + if is_lamp { Vec3::new(40.0, 30.0, 15.0) } else { Vec3::ZERO }
    });
    Environment::map(EnvironmentMap::new(width, height, texels.collect()).unwrap())
}

fn blockers() -> Vec<Sphere> {
    [[0.0, 0.6, 0.0, 0.5], [0.3, 1.1, 0.1, 0.3], [-0.9, 0.35, 0.4, 0.3], [0.9, 0.9, -0.5, 0.35], [0.1, 0.25, 0.9, 0.2]]
        .map(|[x, y, z, radius]| Sphere { center: Vec3::new(x, y, z), radius })
        .to_vec()
}

/// A grid on the ground, and points around the blockers that face away from them.
fn receivers() -> ReceiverBuffer {
    let mut buffer = ReceiverBuffer::default();
    for i in 0..20 * 20 {
        let at = |i: usize| 4.0 * (i as f32 + 0.5) / 20.0 - 2.0;
        buffer.push(Vec3::new(at(i % 20), 0.0, at(i / 20)), Vec3::Y, Vec3::ONE, 0);
    }
    for (number, sphere) in blockers().iter().enumerate() {
        for i in 0..40 {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / 40.0;
            let (sin, cos) = (2.399_963 * (i + number) as f32).sin_cos();
            let across = (1.0 - y * y).sqrt();
            let normal = Vec3::new(across * cos, y, across * sin).normalize();
            buffer.push(sphere.center + sphere.radius * normal, normal, Vec3::ONE, 1);
        }
    }
    buffer
}

/// Root mean square and largest error against the truth, as fractions of the mean unshadowed radiance.
fn errors(scene: &Scene, settings: &str, transport: Transport) -> (f64, f64) {
    let receivers = receivers();
    let frame = scene.frame(0);
    let tracer = Tracer::new(&frame);
    let geometry = Geometry::Spheres(AdjustRule::Continuous);
    let truth = |transport| {
        let options = Options { geometry, transport, samples: 1024, ..Options::default() };
        estimate(&tracer, receivers.view(), &options, &Silent).radiance
    };
    let unshadowed = truth(Transport::Unshadowed);
    let mean = unshadowed.channels.iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / (3 * receivers.len()) as f64;
    let unblocked = Scene { objects: scene.objects.iter().map(without_spheres).collect(), ..scene.clone() };
    let (found, exact) = match transport {
        Transport::Unshadowed => (shaded(&unblocked, settings, &receivers), unshadowed),
        Transport::Shadowed => (shaded(scene, settings, &receivers), truth(transport)),
    };
    let pairs = found.channels.iter().flatten().zip(exact.channels.iter().flatten());
    let (squares, most) = pairs
        .map(|(found, exact)| f64::from((found - exact).abs()) / mean)
        .fold((0.0, 0.0f64), |(sum, most), error| (sum + error * error, most.max(error)));
    ((squares / (3 * receivers.len()) as f64).sqrt(), most)
}

fn without_spheres(object: &Object) -> Object {
    Object { sphere_count: 0, spheres: None, ..object.clone() }
}

#[test]
fn one_sphere_in_constant_light_hides_what_the_closed_form_says() {
    for radius in [0.1, 0.4, 0.8] {
        let sphere = Sphere { center: Vec3::new(0.0, 1.0, 0.0), radius };
        let scene = scene(Environment::constant(Vec3::new(2.0, 1.0, 0.5)), &[sphere]);
        let mut receivers = ReceiverBuffer::default();
        (0..60).for_each(|i| receivers.push(Vec3::new(0.05 * i as f32, 0.0, 0.1), Vec3::Y, Vec3::ONE, 0));
        for (settings, bound) in [("env-depth=3", 0.025), ("env-depth=4", 0.01), ("", 0.004)] {
            let found = shaded(&scene, settings, &receivers);
            let mut worst = 0.0f32;
            for i in 0..receivers.len() {
                let offset = sphere.center - receivers.view().position_at(i);
                let hidden = radius * radius / offset.length_squared() * offset.y / offset.length();
                worst = worst.max((found.at(i).y - (1.0 - hidden)).abs());
                assert!((found.at(i).x - 2.0 * found.at(i).y).abs() < 1e-5);
            }
            assert!(worst < bound, "{radius} {settings}: {worst}");
        }
    }
}

#[test]
fn a_map_without_blockers_is_near_its_irradiance_and_nearer_with_more_lobes() {
    let scene = scene(room(), &blockers());
    for (lobes, bound) in [(0, 0.7), (4, 0.1), (8, 0.02), (16, 0.01), (32, 0.007), (64, 0.007)] {
        let found = errors(&scene, &format!("env-lobes={lobes}"), Transport::Unshadowed);
        assert!(found.1 < bound, "{lobes}: {found:?}");
    }
}

#[test]
fn shadows_of_a_map_are_near_the_truth() {
    let scene = scene(room(), &blockers());
    for (settings, rms, most) in [
        ("env-lobes=8", 0.015, 0.12),
        ("", 0.012, 0.1),
        ("env-lobes=64", 0.012, 0.1),
        ("env-depth=3", 0.035, 0.22),
        ("env-depth=4", 0.015, 0.14),
        ("env-depth=6", 0.01, 0.07),
    ] {
        let found = errors(&scene, settings, Transport::Shadowed);
        assert!(found.0 < rms && found.1 < most, "{settings}: {found:?}");
    }
}

#[test]
fn a_sun_casts_sharp_shadows_and_its_sky_soft_ones() {
    let sun =
        Sun { direction: Vec3::new(0.4, 0.8, 0.2).normalize(), angular_radius: 0.03, radiance: Vec3::splat(600.0) };
    let scene = scene(Environment { sun: Some(sun), ..room() }, &blockers());
    let found = errors(&scene, "", Transport::Shadowed);
    assert!(found.0 < 0.012 && found.1 < 0.1, "{found:?}");
}

#[test]
fn highlights_of_a_map_are_near_the_truth() {
    for (exponent, rms) in [(10.0, 0.015), (40.0, 0.02)] {
        let mut scene = scene(room(), &blockers());
        for object in &mut scene.objects {
            object.material.reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.3), exponent };
        }
        for transport in [Transport::Unshadowed, Transport::Shadowed] {
            let found = errors(&scene, "", transport);
            assert!(found.0 < rms, "{exponent} {transport:?}: {found:?}");
        }
    }
}

#[test]
fn a_turned_environment_is_that_of_a_turned_map() {
    let (width, height) = (64, 32);
    let at = |turn: usize| {
        let texel = |i: usize| {
            let (column, row) = ((i + turn) % width, i / width);
            Vec3::splat(if (10..20).contains(&column) && (5..12).contains(&row) { 9.0 } else { 0.3 })
        };
        let map = EnvironmentMap::new(width, height, (0..width * height).map(texel).collect()).unwrap();
        scene(Environment::map(map), &blockers())
    };
    let receivers = receivers();
    let turned = at(16);
    let mut baked = common::baked(&CosineLobe, &turned, "");
    let by_columns = common::shade(baked.as_mut(), &turned.frame(0), &receivers);
    let straight = at(0);
    let mut frame = straight.frame(0);
    // A quarter of the columns: light comes from as many columns to the left.
    frame.world_from_environment = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let by_quaternion = common::shade(baked.as_mut(), &frame, &receivers);
    for i in 0..receivers.len() {
        let difference = (by_quaternion.at(i) - by_columns.at(i)).abs().max_element();
        assert!(difference < 0.05, "{i}: {} {}", by_quaternion.at(i), by_columns.at(i));
    }
}

#[test]
fn extremes_are_finite_and_not_negative() {
    let texels = |width: usize, height: usize, odd: f32| {
        let mut texels = vec![Vec3::ZERO; width * height];
        texels[width * height / 3] = Vec3::new(odd, odd, 1.0);
        Environment::map(EnvironmentMap::new(width, height, texels).unwrap())
    };
    let sun = |angular_radius: f32| {
        let sun = Sun { direction: Vec3::Y, angular_radius, radiance: Vec3::splat(1e6) };
        Environment { sun: Some(sun), ..Environment::constant(Vec3::ZERO) }
    };
    let environments = [
        texels(32, 16, 0.0),
        texels(1024, 512, 1e6),
        texels(1, 1, 1.0),
        texels(3, 5, f32::NAN),
        texels(3, 5, f32::INFINITY),
        texels(3, 5, -1.0),
        texels(64, 32, 1e-30),
        sun(0.0),
        sun(1e-6),
        sun(1.5),
        sun(3.0),
        Environment::constant(Vec3::ZERO),
        Environment::constant(Vec3::splat(1e6)),
    ];
    let mut spheres = blockers();
    // One around everything, one of no size, one that touches the ground, one far away.
    spheres.extend([
        Sphere { center: Vec3::new(0.0, 5.0, 0.0), radius: 30.0 },
        Sphere { center: Vec3::new(1.0, 0.2, 1.0), radius: 0.0 },
        Sphere { center: Vec3::new(1.5, 0.1, 1.5), radius: 0.1 },
        Sphere { center: Vec3::new(0.0, 1e6, 0.0), radius: 1e5 },
    ]);
    let receivers = receivers();
    for (number, environment) in environments.into_iter().enumerate() {
        for spheres in [&spheres[..0], &spheres[..5], &spheres] {
            let mut scene = scene(environment.clone(), spheres);
            scene.objects[0].material.reflectance = Reflectance::Phong { specular: Vec3::ONE, exponent: 1e5 };
            for settings in ["", "env-lobes=0,env-depth=6,order=published"] {
                let found = shaded(&scene, settings, &receivers);
                let good = |x: &f32| x.is_finite() && *x >= 0.0;
                assert!(found.channels.iter().flatten().all(good), "{settings}, environment {number}");
            }
        }
    }
}
