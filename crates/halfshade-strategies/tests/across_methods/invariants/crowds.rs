//! Many objects in one place: products of many stay within what one of them could leave.

use super::scenes::{Variant, at, ball, fields_and_lobes, lamp, object, shiny, some_vertices};
use glam::Vec3;
use halfshade_scene::{Environment, Mesh, Object, RadianceBuffer, ReceiverBuffer, Scene, builtin::shapes};
use halfshade_strategies::ShadowField;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// White ground and `count` times the same tetrahedron.
fn crowd(count: usize) -> Scene {
    let corners = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]].map(Vec3::from);
    let mesh = Arc::new(Mesh {
        positions: corners.to_vec(),
        normals: corners.map(Vec3::normalize).to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Mesh::default()
    });
    let mut objects = vec![object(shapes::plane(6), None, at(-Vec3::Y, 4.0))];
    objects[0].material.albedo = Vec3::ONE;
    let one = Object { mesh, ..ball(at(Vec3::ZERO, 0.5)) };
    objects.extend(std::iter::repeat_n(one, count));
    Scene::at_rest("crowd", objects, Environment::constant(Vec3::ONE))
}

fn crowd_variants() -> Vec<Variant> {
    let mut all = fields_and_lobes();
    all.push(Variant::new(ShadowField::default(), "shells=8,resolution=8,map=32"));
    all.push(Variant::new(ShadowField::default(), "shells=8,resolution=1,map=8,bands=8"));
    all
}

fn bounds(radiance: &RadianceBuffer) -> [f32; 2] {
    let values = || radiance.channels.iter().flatten().copied();
    assert!(values().all(f32::is_finite));
    [values().fold(f32::MAX, f32::min), values().fold(f32::MIN, f32::max)]
}

/// Under constant light between nothing and the unshadowed, and never brighter for more.
#[test]
fn a_crowd_stays_within_the_unshadowed() {
    for variant in crowd_variants() {
        let mut before: Option<RadianceBuffer> = None;
        for count in [0, 1, 2, 64, 200, 1000] {
            let scene = crowd(count);
            let ground = ReceiverBuffer::gathered(some_vertices(&scene, 1).view(), &(0..49).collect::<Vec<_>>());
            let found = variant.shade(&scene, &ground);
            let [least, most] = bounds(&found);
            // Eight texels along an edge add a cosine up to within a hundredth.
            assert!(least >= -1e-4 && most <= 1.01, "{} {count}: {least} {most}", variant.name());
            for (more, less) in found.channels[0].iter().zip(before.iter().flat_map(|before| &before.channels[0])) {
                assert!(*more <= less + 1e-4, "{} {count}: {more} after {less}", variant.name());
            }
            before = Some(found);
        }
    }
}

/// Under a lamp of solid angle Ω, SH ring: by at most `√Ω |ρ|` with `|ρ|² = 2/(3π)`; nobody else leaves [0, unshadowed].
#[test]
fn a_crowd_under_a_lamp_is_bounded() {
    for variant in crowd_variants() {
        for is_shiny in [false, true] {
            if is_shiny && variant.settings.contains("own=projected") {
                continue;
            }
            let mut scene = crowd(200);
            scene.environment = Environment::constant(Vec3::ZERO);
            let lamp = lamp(Vec3::new(0.5, 4.0, 0.0), 1.0, Vec3::ONE);
            let solid_angle = TAU * (1.0 - (1.0_f32 - 1.0 / 16.0).sqrt());
            scene.lights.push(lamp);
            if is_shiny {
                scene.objects.iter_mut().for_each(shiny);
            }
            let found = variant.shade(&scene, &some_vertices(&scene, 1));
            let [least, most] = bounds(&found);
            // The lobe is .15 (e + 2)/(2π) high, and at most 1 of U's norm squared is its integral.
            let gloss = if is_shiny { 0.15 * 8.0 / TAU * (TAU / 7.0).sqrt() } else { 0.0 };
            let most_of_all = solid_angle.sqrt() * ((2.0 / (3.0 * PI)).sqrt() + gloss);
            assert!(most <= most_of_all && least >= -most_of_all, "{}: {least} {most}", variant.name());
        }
    }
}
