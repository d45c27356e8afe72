//! Work that only one of many needs is done for that one.

use super::scenes::{Variant, apart, at, lamp, lights, models, shiny, some_vertices, still_life, variants};
use crate::common::shade;
use glam::Vec3;
use halfshade_scene::{Environment, Motion, RadianceBuffer, ReceiverBuffer, Scene, Texture};
use halfshade_strategy::Effect;
use std::sync::Arc;

fn exact() -> impl Iterator<Item = Variant> {
    variants().into_iter().filter(|variant| variant.noise == 0.0)
}

fn glossy() -> impl Iterator<Item = Variant> {
    exact().filter(|variant| variant.models(Effect::GlossyReflectance) && !variant.settings.contains("own=projected"))
}

/// Those of one object, or all others.
fn of_object(receivers: &ReceiverBuffer, radiance: &RadianceBuffer, object: u32, is_it: bool) -> RadianceBuffer {
    let kept = |values: &Vec<f32>| {
        let pairs = values.iter().zip(&receivers.object);
        pairs.filter(|&(_, &number)| (number == object) == is_it).map(|(&value, _)| value).collect()
    };
    RadianceBuffer { channels: radiance.channels.each_ref().map(kept) }
}

fn assert_same(a: &RadianceBuffer, b: &RadianceBuffer, place: &str) {
    let [worst, _] = apart(a, b);
    // Cubes of space are laid about the first light.
    assert!(worst < if place.contains("share=") { 0.2 } else { 1e-3 }, "{place}: {worst}");
}

/// A glossy object looks as it does where all are glossy, and changes no other.
#[test]
fn one_glossy_object_among_many() {
    // Under all lights at once.
    let Some((_, scene)) = lights(Vec3::ONE).pop() else { return };
    let receivers = some_vertices(&scene, 47);
    let shines = |is_it: &dyn Fn(usize) -> bool| {
        let mut scene = scene.clone();
        scene.objects.iter_mut().enumerate().filter(|(number, _)| is_it(*number)).for_each(|(_, object)| shiny(object));
        scene
    };
    let (none, all) = (shines(&|_| false), shines(&|_| true));
    for variant in glossy().filter(|variant| models(variant, &scene)) {
        let mut baked = variant.baked(&all);
        let mut shade_in = |scene: &Scene| shade(baked.as_mut(), &scene.frame(0), &receivers);
        let [none, all] = [&none, &all].map(&mut shade_in);
        for number in 0..scene.objects.len() {
            let place = format!("{}, object {number}", variant.name());
            let one = shade_in(&shines(&|other| other == number));
            let part = |radiance, is_it| of_object(&receivers, radiance, number as u32, is_it);
            assert_same(&part(&one, true), &part(&all, true), &place);
            assert_same(&part(&one, false), &part(&none, false), &place);
            // It does shine.
            assert!(apart(&part(&one, true), &part(&none, true))[0] > 1e-3, "{place}");
        }
    }
}

#[test]
fn one_coloured_lamp_among_grey_ones() {
    let lamps = [
        lamp(Vec3::new(-1.5, 3.0, -0.5), 0.3, Vec3::splat(40.0)),
        lamp(Vec3::new(1.5, 2.5, 0.5), 0.2, Vec3::new(0.0, 0.0, 30.0)),
        lamp(Vec3::new(0.5, 4.0, 2.0), 0.5, Vec3::splat(10.0)),
        // Around the scene, and around a part of it.
        lamp(Vec3::ZERO, 20.0, Vec3::new(0.0, 0.1, 0.0)),
        lamp(Vec3::new(1.0, 0.0, 0.5), 0.7, Vec3::new(0.2, 0.0, 0.0)),
    ];
    for is_shiny in [false, true] {
        let mut scene = still_life();
        if is_shiny {
            shiny(&mut scene.objects[1]);
        }
        let receivers = some_vertices(&scene, 23);
        let with = |lights: Vec<_>| Scene { lights, ..scene.clone() };
        let with_lamps: Vec<_> = if is_shiny { glossy().collect() } else { exact().collect() };
        for variant in with_lamps.iter().filter(|variant| variant.models(Effect::LocalLights)) {
            let mut baked = variant.baked(&scene);
            let mut shade_with = |lights| shade(baked.as_mut(), &with(lights).frame(0), &receivers);
            let together = shade_with(lamps.to_vec());
            let mut sum = RadianceBuffer::zeros(receivers.len());
            for lamp in &lamps {
                let alone = shade_with(vec![lamp.clone()]);
                for (sum, alone) in sum.channels.iter_mut().zip(&alone.channels) {
                    sum.iter_mut().zip(alone).for_each(|(sum, alone)| *sum += alone);
                }
            }
            assert_same(&together, &sum, &format!("{}, shiny {is_shiny}", variant.name()));
        }
    }
}

/// The channel of light that only it has is that of white light.
#[test]
fn one_lit_channel() {
    let variants: Vec<_> = exact().collect();
    // Blue counts least.
    let (channel, blue) = (2, lights(Vec3::Z));
    for ((light, white), (_, only)) in lights(Vec3::ONE).iter().zip(&blue) {
        let receivers = some_vertices(white, 197);
        for variant in variants.iter().filter(|variant| models(variant, white)) {
            let [white, only] = [white, only].map(|scene| variant.shade_lit(scene, &receivers));
            let place = format!("{} under {light}", variant.name());
            let pick = |radiance: &RadianceBuffer| RadianceBuffer {
                channels: std::array::from_fn(|_| radiance.channels[channel].clone()),
            };
            // Lobes of a map are fitted to all channels together.
            let [worst, _] = apart(&pick(&only), &pick(&white));
            assert!(worst < 1e-2, "{place}: {worst}");
            assert!((0..3).all(|c| c == channel || only.channels[c].iter().all(|&x| x == 0.0)), "{place}");
        }
    }
}

/// Light by light, of which each needs something else.
#[test]
fn one_light_of_its_kind() {
    let all = lights(Vec3::ONE);
    let receivers = some_vertices(&all[0].1, 23);
    let sun_and = |environment: &Environment| Environment { sun: all[2].1.environment.sun, ..environment.clone() };
    for variant in exact().filter(|variant| variant.models(Effect::LocalLights)) {
        let mut together = all[3].1.clone();
        together.environment = sun_and(&all[0].1.environment);
        let parts = [0, 2, 3].map(|kind| variant.shade_lit(&all[kind].1, &receivers));
        let sum = RadianceBuffer {
            channels: std::array::from_fn(|c| {
                (0..receivers.len()).map(|i| parts.iter().map(|part| part.channels[c][i]).sum()).collect()
            }),
        };
        assert_same(&variant.shade_lit(&together, &receivers), &sum, &variant.name());
    }
}

#[test]
fn one_textured_object() {
    let variants: Vec<_> = exact().collect();
    for (light, scene) in lights(Vec3::ONE) {
        let mut one = scene.clone();
        let texture = Texture::new(2, 1, vec![Vec3::new(0.9, 0.1, 0.0), Vec3::new(0.0, 0.2, 0.7)]).unwrap();
        one.objects[1].material.texture = Some(Arc::new(texture));
        let [plain, textured] = [&scene, &one].map(|scene| some_vertices(scene, 23));
        for variant in variants.iter().filter(|variant| models(variant, &scene)) {
            let mut expected = variant.shade_lit(&scene, &plain);
            for (c, channel) in expected.channels.iter_mut().enumerate() {
                for (i, value) in channel.iter_mut().enumerate() {
                    *value *= textured.view().albedo_at(i)[c] / plain.view().albedo_at(i)[c];
                }
            }
            assert_same(&variant.shade_lit(&one, &textured), &expected, &format!("{} under {light}", variant.name()));
        }
    }
}

/// In the middle of its way, one object is where it would be at rest.
#[test]
fn one_moving_object() {
    let variants: Vec<_> = exact().collect();
    for (light, mut scene) in lights(Vec3::ONE).into_iter().skip(5) {
        scene.frames_per_sec = 1.0;
        let mut moving = scene.clone();
        let to = at(Vec3::new(-0.5, 1.6, 0.2), 0.5);
        moving.objects[1].motion = Motion::Keyframes(vec![(0.0, moving.objects[1].motion.at(0.0)), (1.0, to)]);
        moving.frame_count = 2;
        scene.objects[1].motion = Motion::Still(to);
        let receivers = some_vertices(&scene, 23);
        for variant in variants.iter().filter(|variant| models(variant, &scene)) {
            let mut baked = variant.baked(&moving);
            // From another frame to this one: nothing of the other may stay.
            shade(baked.as_mut(), &moving.frame(0), &receivers);
            let found = shade(baked.as_mut(), &moving.frame(1), &receivers);
            assert_same(&found, &variant.shade_lit(&scene, &receivers), &format!("{} under {light}", variant.name()));
        }
    }
}
