//! Glossy transfer against quadrature and the truth, and at its ends.

use crate::{
    common,
    prt::{
        convergence::assert_converged,
        scenes::{limited_light, torus_over_ground},
    },
};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Cache, Environment, EyeLobes, LafortuneLobe, Material, Mesh, Object, Progress, RadianceBuffer, ReceiverBuffer,
    Reflectance, Scene,
    builtin::{self, shapes},
    progress::Silent,
};
use halfshade_strategies::{Prt, prt::sharpness::shown_exponent};
use halfshade_strategy::{Strategy, StrategyError};
use halfshade_truth::{Options, Tracer, estimate};
use std::f64::consts::TAU;

fn phong(exponent: f32) -> Reflectance {
    Reflectance::Phong { specular: Vec3::new(0.6, 0.4, 0.5), exponent }
}

fn modified(exponent: f32) -> Reflectance {
    Reflectance::ModifiedPhong { specular: Vec3::new(0.5, 0.4, 0.3), exponent }
}

/// One lobe near the mirrored direction and one back to the light, in other colours.
fn lafortune(exponent: f32) -> Reflectance {
    let lobe = |scale: Vec3, axis: Vec3| LafortuneLobe { scale, axis, exponent };
    let mirrored = lobe(Vec3::new(0.5, 0.3, 0.1), Vec3::new(-0.95, -0.9, 1.0));
    Reflectance::Lafortune { lobes: vec![mirrored, lobe(Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.8, 0.8, 0.9))] }
}

/// Everything is glossy, seen from aside.
fn glossy(mut scene: Scene, reflectance: &Reflectance) -> Scene {
    scene.objects.iter_mut().for_each(|object| object.material.reflectance = reflectance.clone());
    scene.camera.eye = Vec3::new(1.5, 3.0, 2.5);
    scene
}

fn shaded(scene: &Scene, receivers: &ReceiverBuffer, settings: &str) -> RadianceBuffer {
    common::shaded(&Prt::default(), scene, &scene.frame(0), receivers, settings)
}

fn some_vertices(scene: &Scene, step: usize) -> ReceiverBuffer {
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let some: Vec<u32> = (0..all.len() as u32).step_by(step).collect();
    ReceiverBuffer::gathered(all.view(), &some)
}

/// `∫ L c dω` over the hemisphere of a receiver by the midpoint rule, with c its lobes and its diffuse part.
fn quadrature(scene: &Scene, receivers: &ReceiverBuffer, i: usize) -> DVec3 {
    let frame = scene.frame(0);
    let view = receivers.view();
    let lobes = EyeLobes::new(&frame).unwrap().at(&view, i);
    let normal = view.normal_at(i).as_dvec3().normalize();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (rings, spokes) = (96, 192);
    let mut sum = DVec3::ZERO;
    for ring in 0..rings {
        let up = (f64::from(ring) + 0.5) / f64::from(rings);
        for spoke in 0..spokes {
            let (sin, cos) = (TAU * (f64::from(spoke) + 0.5) / f64::from(spokes)).sin_cos();
            let along = up * normal + (1.0 - up * up).sqrt() * (cos * tangent + sin * bitangent);
            let diffuse = view.albedo_at(i).as_dvec3() * up / std::f64::consts::PI;
            sum += scene.environment.radiance(along.as_vec3()).as_dvec3() * (diffuse + lobes.value(normal, along));
        }
    }
    sum * TAU / f64::from(rings * spokes)
}

/// Where nothing is hidden, gloss of any model is exact under light of no more bands, but for the fit's ridge.
#[test]
fn open_gloss_is_that_of_quadrature() {
    let ball = Object::new("ball", shapes::sphere(7)).albedo(Vec3::new(0.3, 0.2, 0.1));
    for (model, settings, room) in [
        (phong(3.0), "bands=4,directions=256", 5e-3),
        (modified(2.0), "bands=3,directions=64", 5e-3),
        (modified(1.0), "bands=4,directions=64", 5e-3),
        (modified(25.0), "bands=4,transfer=unshadowed", 2e-2),
        (lafortune(8.0), "bands=6,directions=64", 1e-2),
    ] {
        let light = limited_light(3, 21);
        let scene = glossy(Scene::at_rest("ball", vec![ball.clone()], light), &model);
        let mut receivers = some_vertices(&scene, 3);
        // Receivers of which nothing is known see everything as well.
        for i in 0..3 {
            let (position, normal) = (receivers.view().position_at(i), receivers.view().normal_at(i));
            receivers.push(position, (normal + 0.2 * Vec3::X).normalize(), Vec3::splat(0.4), 0);
        }
        let found = shaded(&scene, &receivers, settings);
        let mean =
            (0..receivers.len()).map(|i| quadrature(&scene, &receivers, i)).sum::<DVec3>() / receivers.len() as f64;
        for i in 0..receivers.len() {
            let exact = quadrature(&scene, &receivers, i);
            let error = (found.at(i).as_dvec3() - exact).abs().max_element() / mean.max_element();
            assert!(error < room, "{model:?} {settings} {i}: {} {exact}", found.at(i));
        }
    }
}

/// Soft gloss is the truth under limited light, within the truth's standard error.
#[test]
fn soft_gloss_is_the_truth_under_limited_light() {
    for (model, bands, settings) in [
        (modified(3.0), 4, "bands=4,directions=4096"),
        (phong(2.0), 3, "bands=6,directions=4096"),
        (lafortune(2.0), 3, "bands=5,directions=4096"),
    ] {
        let scene = glossy(torus_over_ground(limited_light(bands, 5), [Vec3::splat(0.4); 2]), &model);
        let receivers = some_vertices(&scene, 3);
        let found = shaded(&scene, &receivers, settings);
        assert_converged(settings, &scene, &receivers, &found);
    }
}

/// A glossy ground reflects what a coloured torus sends to it.
#[test]
fn gloss_reflects_what_others_send() {
    let ground = Vec3::splat(0.2);
    let mut scene = torus_over_ground(limited_light(3, 6), [ground, Vec3::new(0.9, 0.3, 0.2)]);
    scene.bounces = 1;
    scene.objects[0].material.reflectance = modified(4.0);
    scene.camera.eye = Vec3::new(1.5, 3.0, 2.5);
    // The ground's own: to the torus it sends gloss as well, which transfer knows nothing of.
    let all = ReceiverBuffer::vertices(&scene.frame(0));
    let ground: Vec<u32> = (0..all.len() as u32).filter(|&i| all.view().object[i as usize] == 0).collect();
    let receivers = ReceiverBuffer::gathered(all.view(), &ground);
    let found = shaded(&scene, &receivers, "bands=5,directions=4096");
    assert_converged("one bounce", &scene, &receivers, &found);
}

#[test]
fn ends_are_finite_and_bounded() {
    for reflectance in [modified(0.0), modified(1.0), modified(1e5), phong(1e5), lafortune(1e5)] {
        for (albedo, settings) in [(Vec3::ZERO, "bands=1,directions=16"), (Vec3::splat(0.5), "bands=8,directions=64")] {
            let scene = torus_over_ground(Environment::constant(Vec3::ONE), [albedo; 2]);
            let scene = Scene { bounces: 2, ..glossy(scene, &reflectance) };
            let receivers = some_vertices(&scene, 7);
            let found = shaded(&scene, &receivers, settings);
            for i in 0..receivers.len() {
                let radiance = found.at(i);
                let is_bounded = matches!(reflectance, Reflectance::Lafortune { .. })
                    || (radiance.min_element() > -0.3 && radiance.max_element() < 2.0);
                assert!(radiance.is_finite() && is_bounded, "{reflectance:?} {settings}: {radiance}");
            }
        }
    }
}

#[test]
fn degenerate_meshes_are_no_trouble() {
    let flat = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::ZERO, Vec3::Y],
        normals: vec![Vec3::Y, Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 0, 0], [0, 3, 1], [0, 1, 4]],
        ..Mesh::default()
    };
    for mesh in [flat, Mesh::default()] {
        let material = Material { reflectance: modified(20.0), ..Material::new(Vec3::splat(0.3)) };
        let objects = vec![Object::new("end", mesh).material(material)];
        let scene = Scene { bounces: 1, ..Scene::at_rest("ends", objects, Environment::constant(Vec3::ONE)) };
        let mut receivers = ReceiverBuffer::vertices(&scene.frame(0));
        receivers.push(Vec3::ONE, Vec3::Y, Vec3::ONE, 0);
        let found = shaded(&scene, &receivers, "directions=32");
        assert!((0..receivers.len()).all(|i| found.at(i).is_finite()));
    }
}

/// Too many matrices are refused before any is made; diffuse objects have none.
#[test]
fn memory_is_told_and_bounded() {
    let plane = |cells: usize, reflectance: Reflectance| {
        let material = Material { reflectance, ..Material::new(Vec3::splat(0.5)) };
        let scene = Object::new("plane", shapes::plane(cells)).material(material);
        Scene::at_rest("plane", vec![scene], Environment::constant(Vec3::ONE))
    };
    let baked = |scene: &Scene, settings: &str| {
        Prt::default().bake(scene, &Prt::default().info().parse(settings).unwrap(), &Silent)
    };
    let Err(StrategyError::Unsupported(reason)) = baked(&plane(600, modified(5.0)), "bands=8") else {
        panic!("not refused")
    };
    assert!(reason.contains("MB") && reason.contains("fewer bands"), "{reason}");
    let bytes = |reflectance: Reflectance| {
        let footprint = baked(&plane(3, reflectance), "bands=3,transfer=unshadowed").unwrap().footprint();
        footprint.parts.iter().find(|(part, _)| *part == "transfer matrices").map(|(_, bytes)| *bytes)
    };
    assert_eq!(bytes(Reflectance::Lambert), None);
    assert!(bytes(modified(5.0)).unwrap() > 16 * 81 * 4);
}

#[test]
fn matrices_are_cached_and_have_the_same_bits_on_one_thread() {
    let folder = tempfile::tempdir().unwrap();
    let scene = torus_over_ground(limited_light(2, 3), [Vec3::new(0.5, 0.4, 0.3), Vec3::splat(0.3)]);
    let scene = Scene { bounces: 1, ..glossy(scene, &modified(6.0)) };
    let receivers = some_vertices(&scene, 1);
    let kept = Prt::new(Cache::open(Some(folder.path().into())));
    let shade = |strategy: &Prt| {
        let found = common::shaded(strategy, &scene, &scene.frame(0), &receivers, "bands=3,directions=32");
        found.channels.map(|channel| channel.into_iter().map(f32::to_bits).collect::<Vec<_>>())
    };
    let first = shade(&kept);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "direct light, a bounce, matrices");
    assert_eq!(first, shade(&kept));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(first, one.install(|| shade(&Prt::default())));
}

/// A dull object keeps its bits, and a glossy one gains light.
#[test]
fn a_dull_object_is_not_touched_by_a_shiny_one() {
    let mut scene = torus_over_ground(limited_light(3, 8), [Vec3::splat(0.6); 2]);
    scene.camera.eye = Vec3::new(1.5, 3.0, 2.5);
    let receivers = some_vertices(&scene, 5);
    let dull = shaded(&scene, &receivers, "bands=3,directions=32");
    scene.objects[1].material.reflectance = phong(3.0);
    let mixed = shaded(&scene, &receivers, "bands=3,directions=32");
    let mut gained = Vec3::ZERO;
    for i in 0..receivers.len() {
        let change = mixed.at(i) - dull.at(i);
        assert!(receivers.view().object[i] == 1 || change == Vec3::ZERO);
        gained += change / receivers.len() as f32;
    }
    assert!(gained.min_element() > 0.05, "{gained}");
}

/// Error of gloss without a diffuse part in captured-like light, as a part of the mean unshadowed radiance.
fn error_of_gloss(exponent: f32, settings: &str) -> f64 {
    let scene = glossy(torus_over_ground(builtin::studio(), [Vec3::ZERO; 2]), &modified(exponent));
    let receivers = some_vertices(&scene, 11);
    let found = shaded(&scene, &receivers, settings);
    let options = Options { samples: 64, ..Options::default() };
    let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent);
    let sum = |of: &dyn Fn(usize, usize) -> f32| -> f64 {
        (0..3).flat_map(|channel| (0..receivers.len()).map(move |i| f64::from(of(channel, i)).powi(2))).sum()
    };
    let error = sum(&|channel, i| found.channels[channel][i] - truth.radiance.channels[channel][i]);
    let noise = sum(&|channel, i| truth.standard_error.channels[channel][i]);
    ((error - noise).max(0.0) / (3 * receivers.len()) as f64).sqrt() / truth.unshadowed_mean
}

/// Up to the exponent that is told, gloss errs by a tenth or so; far beyond it errs by much more, and that is told too.
#[test]
fn gloss_as_sharp_as_told_is_shown() {
    for bands in [4, 6] {
        let shown = shown_exponent(bands) as f32;
        let settings = format!("bands={bands},directions=256");
        let [at, past] = [shown, 16.0 * shown].map(|exponent| error_of_gloss(exponent, &settings));
        assert!(at < 0.15 && past > 0.4, "{bands}: {at} {past}");
    }
}

#[test]
fn sharp_gloss_is_told() {
    #[derive(Default)]
    struct Notes(std::sync::Mutex<Vec<String>>);
    impl Progress for Notes {
        fn start(&self, _: &str, _: u64) {}

        fn advance(&self, _: u64) {}

        fn note(&self, note: &str) {
            self.0.lock().unwrap().push(note.into());
        }
    }
    let notes = |exponent: f32| {
        let scene = glossy(torus_over_ground(Environment::constant(Vec3::ONE), [Vec3::ZERO; 2]), &modified(exponent));
        let (notes, params) = (Notes::default(), Prt::default().info().parse("transfer=unshadowed").unwrap());
        let details = Prt::default().bake(&scene, &params, &notes).unwrap().details();
        let told = details.into_iter().find(|detail| detail.name.contains("exponent")).unwrap().values;
        assert_eq!(told, [f64::from(exponent), shown_exponent(4)]);
        notes.0.into_inner().unwrap()
    };
    assert!(notes(1.0).is_empty());
    let sharp = notes(200.0).concat();
    assert!(sharp.contains("`ground` has 200") && sharp.contains("more bands"), "{sharp}");
}
