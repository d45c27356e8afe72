//! Far things take no digit of near ones: neither objects nor lamps, whoever of them comes first.

use super::scenes::{apart, at, ball, lamp, lights, models, some_vertices, still_life, variants_baked_anew};
use glam::Vec3;
use halfshade_scene::{RadianceBuffer, ReceiverBuffer, Scene};

/// The near ground, ball and ball, in that order, wherever they are among the objects.
fn near(scene: &Scene, objects: [u32; 3]) -> ReceiverBuffer {
    let all = some_vertices(scene, 1);
    let numbers = 0..all.len() as u32;
    let of = |object: u32| numbers.clone().filter(|&i| all.object[i as usize] == object).step_by(7).collect::<Vec<_>>();
    ReceiverBuffer::gathered(all.view(), &objects.map(of).concat())
}

#[test]
fn a_far_object_changes_nothing() {
    for variant in variants_baked_anew() {
        for (light, scene) in
            lights(Vec3::ONE).into_iter().filter(|(light, _)| ["constant", "near lamp"].contains(light))
        {
            if !models(&variant, &scene) {
                continue;
            }
            let without = variant.shade(&scene, &near(&scene, [0, 1, 2]));
            // First or last: who is far away under one light comes before the others, under the other after them.
            let (place, objects) = if light == "constant" { (0, [1, 2, 3]) } else { (scene.objects.len(), [0, 1, 2]) };
            let mut wider = scene.clone();
            wider.objects.insert(place, ball(at(Vec3::new(1e8, 0.6, 0.0), 0.3)));
            let with = variant.shade(&wider, &near(&wider, objects));
            let [_, rms] = apart(&with, &without);
            assert!(rms <= 1e-4 + variant.noise, "{} {light} {place}: {rms}", variant.name());
        }
    }
}

/// A lamp of the sun's size and distance, and one that looks the same from a thousand times the scene's size.
#[test]
fn a_lamp_may_be_as_far_as_the_sun() {
    let direction = Vec3::new(0.4, 1.0, 0.3).normalize();
    for variant in variants_baked_anew() {
        let lit = |distance: f32| -> Option<RadianceBuffer> {
            let mut scene = still_life();
            scene.lights = vec![
                lamp(distance * direction, 0.0047 * distance, Vec3::splat(4e4)),
                lamp(Vec3::new(-1.5, 3.0, -0.5), 0.3, Vec3::splat(10.0)),
            ];
            models(&variant, &scene).then(|| variant.shade(&scene, &some_vertices(&scene, 7)))
        };
        let Some((sun, near)) = lit(1.5e11).zip(lit(3_000.0)) else { continue };
        let [_, rms] = apart(&sun, &near);
        assert!(rms < 0.01 + variant.noise, "{}: {rms}", variant.name());
    }
}
