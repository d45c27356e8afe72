//! Transfer whose vector is known.

use crate::prt::scenes::{torus_over_ground, vertices};
use glam::{DVec3, Vec3};
use halfshade_scene::{Environment, Mesh, Object, ReceiverBuffer, Scene, builtin::shapes, progress::Silent};
use halfshade_sh::{basis, zonal};
use halfshade_strategies::{Prt, Unshadowed};
use halfshade_strategy::Strategy;
use std::f64::consts::{PI, TAU};

fn rows(scene: &Scene, settings: &str) -> Vec<f32> {
    let strategy = Prt::default();
    let params = strategy.info().parse(settings).unwrap();
    strategy.bake_scene(scene, &params, &Silent).unwrap().scene_arrays().rows.to_vec()
}

#[test]
fn unshadowed_transfer_is_the_clamped_cosine() {
    let scene = torus_over_ground(Environment::constant(Vec3::ONE), [Vec3::ONE; 2]);
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    for bands in 1..=8 {
        let count = bands * bands;
        let rows = rows(&scene, &format!("bands={bands},transfer=unshadowed"));
        assert_eq!(rows.len(), receivers.len() * count);
        let cosine: Vec<f64> = zonal::clamped_cosine(bands).iter().map(|value| value / PI).collect();
        for (i, row) in rows.chunks_exact(count).enumerate() {
            let exact = zonal::rotate_to_axis(&cosine, receivers.view().normal_at(i).as_dvec3().normalize().to_array());
            assert!(row.iter().zip(&exact).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{bands} {i}");
        }
    }
}

/// A wall without end at a right angle, on the edge of which a vertex stands.
fn foot_of_a_wall() -> Scene {
    let far = 1e4;
    let mesh = |positions: [Vec3; 4], normal: Vec3| Mesh {
        positions: positions.to_vec(),
        normals: vec![normal; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let wall = [(-far, -far), (far, -far), (far, far), (-far, far)].map(|(y, z)| Vec3::new(-1e-3, y, z));
    let speck = [(0.0, 0.0), (0.0, 1e-4), (1e-4, 1e-4), (1e-4, 0.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let objects = vec![
        Object::new("wall", mesh(wall, Vec3::X)).albedo(Vec3::splat(0.5)),
        Object::new("speck", mesh(speck, Vec3::Y)),
    ];
    Scene::at_rest("wall", objects, Environment::constant(Vec3::ONE))
}

#[test]
fn a_wall_hides_half_of_the_sky() {
    let bands = 4;
    // Half of the hemisphere, by the midpoint rule in equal steps of sin².
    let (rings, spokes) = (400, 800);
    let mut exact = vec![0.0; bands * bands];
    for ring in 0..rings {
        let squared = (f64::from(ring) + 0.5) / f64::from(rings);
        for spoke in 0..spokes {
            let (sin, cos) = (TAU * (f64::from(spoke) + 0.5) / f64::from(spokes)).sin_cos();
            if cos > 0.0 {
                let across = squared.sqrt();
                let y =
                    basis::evaluate(bands, DVec3::new(across * cos, (1.0 - squared).sqrt(), across * sin).to_array());
                exact.iter_mut().zip(&y).for_each(|(sum, y)| *sum += y / f64::from(rings * spokes));
            }
        }
    }
    let scene = foot_of_a_wall();
    let rows = rows(&scene, "directions=4096");
    for row in rows.chunks_exact(16).skip(4).take(4) {
        assert!((f64::from(row[0]) * (4.0 * PI).sqrt() - 0.5).abs() < 1e-3, "{row:?}");
        assert!(row.iter().zip(&exact).all(|(a, b)| (f64::from(*a) - b).abs() < 2e-3), "{row:?} {exact:?}");
    }
}

/// A wall of albedo 0.5 that sees half of the sky, its other half hidden by nothing: light that it sends to the speck.
#[test]
fn a_wall_gives_back_what_it_reflects() {
    let scene = Scene { bounces: 1, ..foot_of_a_wall() };
    let (_, radiance) = vertices(&scene, "directions=4096");
    // The wall sees all of the sky, since the speck hides nothing worth mentioning.
    for i in 4..8 {
        let found = radiance.at(i);
        assert!((found - Vec3::splat(0.5 + 0.5 * 0.5)).abs().max_element() < 2e-3, "{found}");
    }
}

/// Without anything in the way, constant light is exact however few the rays and the bands.
#[test]
fn an_open_sky_is_exact() {
    let ball = Object::new("ball", shapes::sphere(12)).albedo(Vec3::new(1.0, 0.5, 0.2));
    let sky = Vec3::new(1.0, 2.0, 3.0);
    let scene = Scene { bounces: 2, ..Scene::at_rest("ball", vec![ball], Environment::constant(sky)) };
    for settings in ["bands=1,directions=16", "bands=4", "bands=8,directions=64", "transfer=shadowed,bands=3"] {
        let (receivers, radiance) = vertices(&scene, settings);
        for i in 0..receivers.len() {
            let exact = sky * receivers.view().albedo_at(i);
            assert!((radiance.at(i) - exact).abs().max_element() < 2e-6 * 3.0, "{settings}: {}", radiance.at(i));
        }
    }
}

/// Receivers that lie on no mesh are lit as by who knows no shadows, up to the bands.
#[test]
fn who_lies_nowhere_sees_everything() {
    let scene = torus_over_ground(super::scenes::limited_light(3, 4), [Vec3::ONE; 2]);
    let frame = scene.frame(0);
    let mut receivers = ReceiverBuffer::default();
    for i in 0..21 {
        let (sin, cos) = (0.7 * i as f32).sin_cos();
        receivers.push(Vec3::new(cos, 0.2, sin), Vec3::new(cos, sin, 0.3).normalize(), Vec3::new(1.0, 0.5, 0.1), 0);
    }
    let found = crate::common::shaded(&Prt::default(), &scene, &frame, &receivers, "bands=4,directions=16");
    let exact = crate::common::shaded(&Unshadowed, &scene, &frame, &receivers, "normals=64");
    for i in 0..receivers.len() {
        let (found, exact) = (found.at(i), exact.at(i));
        assert!((found - exact).abs().max_element() < 5e-3 * exact.max_element(), "{found} {exact}");
    }
}
