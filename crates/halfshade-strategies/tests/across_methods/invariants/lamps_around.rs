//! Receivers within a lamp, which see it all around.

use super::scenes::{Variant, apart, at, ball, lamp, object, shiny, some_vertices, still_life, variants};
use glam::Vec3;
use halfshade_scene::{Environment, RadianceBuffer, ReceiverBuffer, Scene, builtin::shapes, progress::Silent};
use halfshade_strategy::Effect;
use halfshade_truth::{Options, Tracer, estimate};

fn lamp_strategies() -> impl Iterator<Item = Variant> {
    variants().into_iter().filter(|variant| variant.models(Effect::LocalLights))
}

/// Those that know what is before a lamp that surrounds them and what behind, and before which the ground stands: `sh-exp` says
/// that it doesn't.
fn surrounded_strategies() -> impl Iterator<Item = Variant> {
    lamp_strategies().filter(|variant| variant.strategy.info().name != "sh-exp")
}

fn truth(scene: &Scene, receivers: &ReceiverBuffer, samples: usize) -> RadianceBuffer {
    let options = Options { samples, ..Options::default() };
    estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent).radiance
}

/// The light of a constant environment, shadows of blockers included; off the middle, and also where things shine.
#[test]
fn a_lamp_around_the_scene_is_a_constant_environment() {
    let radiance = Vec3::new(1.0, 0.5, 0.0);
    for is_shiny in [false, true] {
        let mut open = still_life();
        if is_shiny {
            open.objects.iter_mut().for_each(shiny);
        }
        let mut within = open.clone();
        open.environment = Environment::constant(radiance);
        within.lights.push(lamp(Vec3::new(7.0, -3.0, 5.0), 30.0, radiance));
        let receivers = some_vertices(&open, 7);
        let [_, rms] = apart(&truth(&within, &receivers, 1024), &truth(&open, &receivers, 1024));
        assert!(rms < 0.02, "truth, shiny {is_shiny}: {rms}");
        for variant in surrounded_strategies() {
            let refuses = !variant.models(Effect::GlossyReflectance) || variant.settings.contains("own=projected");
            if is_shiny && refuses {
                continue;
            }
            let [worst, rms] = apart(&variant.shade(&within, &receivers), &variant.shade(&open, &receivers));
            let place = format!("{}, shiny {is_shiny}: {worst} {rms}", variant.name());
            if variant.noise == 0.0 {
                assert!(worst < 2e-3, "{place}")
            } else {
                assert!(rms < variant.noise, "{place}")
            }
        }
    }
}

/// On a floor, the lamp's centre below it: all of the hemisphere is the lamp.
#[test]
fn a_sunken_lamp_lights_who_is_in_it_in_full() {
    for (depth, radius) in [(0.2, 0.5), (0.0, 0.5), (0.49, 0.5), (-0.3, 0.5), (3.0, 3.1)] {
        let mut scene = Scene::at_rest(
            "sunken",
            vec![object(shapes::plane(8), None, at(Vec3::ZERO, 1.0))],
            Environment::constant(Vec3::ZERO),
        );
        scene.lights.push(lamp(-depth * Vec3::Y, radius, Vec3::ONE));
        let mut receivers = ReceiverBuffer::default();
        receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
        let exact = truth(&scene, &receivers, 1024).at(0).x;
        assert!((exact - 1.0).abs() < 1e-3, "truth {depth}: {exact}");
        for variant in lamp_strategies() {
            let found = variant.shade(&scene, &receivers).at(0).x;
            // Eight texels along an edge add a cosine up to within a hundredth.
            assert!((found - 1.0).abs() < 0.01 + 0.1 * variant.noise, "{} {depth}: {found}", variant.name());
        }
    }
}

/// From within, nobody outside of the lamp is before it; from outside, nobody within.
#[test]
fn a_lamps_surface_is_before_what_is_behind_it() {
    let mut scene = still_life();
    scene.objects.truncate(1);
    scene.objects.push(ball(at(Vec3::new(0.0, 2.0, 0.0), 0.5)));
    let mut receivers = ReceiverBuffer::default();
    receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
    for (center, radius) in [(Vec3::ZERO, 1.2), (Vec3::new(0.2, 2.1, 0.1), 0.9)] {
        scene.lights = vec![lamp(center, radius, Vec3::ONE)];
        let alone = Scene { objects: scene.objects[..1].to_vec(), ..scene.clone() };
        let [exact, open] = [&scene, &alone].map(|scene| truth(scene, &receivers, 1024).at(0).x);
        assert!((exact / open - 1.0).abs() < 0.01, "{exact} {open}");
        for variant in surrounded_strategies() {
            let [found, open] = [&scene, &alone].map(|scene| variant.shade(scene, &receivers).at(0).x);
            assert!((found / open - 1.0).abs() < 0.01 + variant.noise, "{} {radius}: {found} {open}", variant.name());
        }
    }
}

/// Into a lamp with the eye on its centre, past a blocker outside of it: no step, and what the truth says.
#[test]
fn the_way_into_a_lamp_is_continuous() {
    let mut scene = still_life();
    scene.objects =
        vec![object(shapes::plane(2), None, at(-5.0 * Vec3::Y, 1.0)), ball(at(Vec3::new(1.75, 0.55, 0.0), 0.25))];
    scene.lights = vec![lamp(Vec3::ZERO, 1.0, Vec3::ONE)];
    let mut receivers = ReceiverBuffer::default();
    for i in 0..=300 {
        receivers.push(Vec3::new(3.0 - 2.8 * i as f32 / 300.0, 0.0, 0.0), -Vec3::X, Vec3::ONE, 0);
    }
    let exact = truth(&scene, &receivers, 256);
    for variant in lamp_strategies().filter(|variant| variant.noise == 0.0) {
        let found = variant.shade(&scene, &receivers);
        let step = found.channels[0].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
        // A published light has a lobe of 4 % too much from outside.
        let published = variant.settings.contains("published");
        assert!(step < if published { 0.08 } else { 0.06 }, "{}: {step}", variant.name());
        // Bands and texels blur the lamp's edge, and the unshadowed have no blocker.
        let [_, rms] = apart(&found, &exact);
        let most = if variant.name() == "cosine-lobe:" { 0.02 } else { 0.12 };
        assert!(rms < most, "{}: {rms}", variant.name());
    }
}
