//! Work that a scene doesn't require isn't done: here one object, light or channel alone requires it.
//!
//! Light transport keeps channels apart. Whatever is coloured, each channel must come out as it does in the grey scene that has
//! this channel's values everywhere, where no colour is looked for at all.

use crate::common;
use glam::{DVec2, Vec3};
use halfshade_scene::{
    Environment, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereLight, SphereSet, Texture,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
};
use halfshade_strategies::{RayTraced, ShExp, Unshadowed};
use halfshade_strategy::Strategy;
use std::sync::Arc;

fn object(name: &str, mesh: halfshade_scene::Mesh, spheres: usize, pose: Pose) -> Object {
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    let object = Object::new(name, mesh).albedo(Vec3::splat(0.8)).cluster_count(1).pose(pose);
    if spheres > 0 { object.spheres(set) } else { object }
}

/// Two grey balls over a grey ground under a grey sky, with two bounces.
fn grey() -> Scene {
    let ball = |x| {
        let pose = Pose { scale: 0.5, ..Pose::from_translation(Vec3::new(x, 0.7, 0.1 * x)) };
        object("ball", shapes::sphere(8), 1, pose)
    };
    let ground = object("ground", shapes::plane(6), 0, Pose { scale: 4.0, ..Pose::IDENTITY });
    let objects = vec![ball(-0.55), ball(0.55), ground];
    Scene { bounces: 2, ..Scene::at_rest("grey", objects, Environment::constant(Vec3::ONE)) }
}

const RED: Vec3 = Vec3::new(0.9, 0.2, 0.05);

fn map(texel: impl Fn(usize) -> Vec3) -> Environment {
    Environment::map(EnvironmentMap::new(16, 8, (0..128).map(texel).collect()).unwrap())
}

/// The grey scene with one thing coloured, by name.
fn coloured() -> Vec<(&'static str, Scene)> {
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = grey();
        change(&mut scene);
        scene
    };
    let texture = || {
        let texels = (0..16).map(|i| if i == 5 { Vec3::new(0.1, 0.9, 0.3) } else { Vec3::splat(0.5) });
        Some(Arc::new(Texture::new(4, 4, texels.collect()).unwrap()))
    };
    let vertex_colours = |object: &mut Object| {
        let mesh = Arc::make_mut(&mut object.mesh);
        mesh.colors = vec![Vec3::splat(0.7); mesh.positions.len()];
        mesh.colors.iter_mut().step_by(3).for_each(|color| *color = Vec3::new(0.2, 0.4, 1.0));
    };
    let sun = |radiance| Some(Sun { direction: Vec3::new(0.6, 0.8, 0.0), angular_radius: 0.1, radiance });
    vec![
        ("ground", with(&|s| s.objects[2].material.albedo = RED)),
        ("ground's vertices", with(&|s| vertex_colours(&mut s.objects[2]))),
        ("ground's texture", with(&|s| s.objects[2].material.texture = texture())),
        ("first ball", with(&|s| s.objects[0].material.albedo = RED)),
        ("last ball's vertices", with(&|s| vertex_colours(&mut s.objects[1]))),
        ("last ball's texture", with(&|s| s.objects[1].material.texture = texture())),
        ("only the last ball reflects", {
            with(&|s| {
                s.objects.iter_mut().for_each(|object| object.material.albedo = Vec3::ZERO);
                s.objects[1].material.albedo = Vec3::new(0.0, 0.0, 0.7);
            })
        }),
        ("only the ground reflects", {
            with(&|s| {
                s.objects.iter_mut().for_each(|object| object.material.albedo = Vec3::ZERO);
                s.objects[2].material.albedo = Vec3::new(0.0, 0.6, 0.0);
            })
        }),
        ("constant sky", with(&|s| s.environment = Environment::constant(Vec3::new(1.0, 1.0, 0.5)))),
        ("one texel", with(&|s| s.environment = map(|i| if i == 21 { 9.0 * RED } else { Vec3::ONE }))),
        ("last texel", with(&|s| s.environment = map(|i| if i == 127 { RED } else { Vec3::ONE }))),
        ("sun", with(&|s| s.environment.sun = sun(20.0 * RED))),
        ("sun alone in the dark", {
            with(&|s| {
                s.environment = Environment::constant(Vec3::ZERO);
                s.environment.sun = sun(Vec3::new(0.0, 0.0, 30.0));
            })
        }),
    ]
}

fn with_lamps() -> Vec<(&'static str, Scene)> {
    let lamp = |x: f32, radiance| {
        let light = SphereLight { center: Vec3::new(x, 2.5, 0.4), radius: 0.3, radiance };
        (light, Motion::Still(Pose::IDENTITY))
    };
    let mut scene = grey();
    scene.bounces = 0;
    scene.lights = vec![lamp(-1.0, Vec3::splat(5.0)), lamp(1.0, 8.0 * RED)];
    let mut alone = scene.clone();
    alone.environment = Environment::constant(Vec3::ZERO);
    vec![("second lamp", scene), ("lamps in the dark", alone)]
}

/// The scene with the values of one channel in all channels.
fn channel_of(scene: &Scene, channel: usize) -> Scene {
    let grey = |color: Vec3| Vec3::splat(color[channel]);
    let mut one = scene.clone();
    for object in &mut one.objects {
        object.material.albedo = grey(object.material.albedo);
        object.material.texture = object.material.texture.as_ref().map(|texture| {
            // Texel by texel, at their centres.
            let at = |i: u32| texture.at(DVec2::new(f64::from(i % 4) + 0.5, f64::from(i / 4) + 0.5) / 4.0);
            let rows: Vec<Vec3> = (0..16).map(|i| grey(at(i))).collect();
            let straight = Texture::new(4, 4, rows.clone()).unwrap();
            // Rows may be counted from either end.
            let probe = DVec2::new(0.125, 0.125);
            if straight.at(probe) == grey(texture.at(probe)) {
                Arc::new(straight)
            } else {
                Arc::new(Texture::new(4, 4, rows.chunks(4).rev().flatten().copied().collect()).unwrap())
            }
        });
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

fn shade(strategy: &dyn Strategy, settings: &str, scene: &Scene) -> RadianceBuffer {
    let frame = scene.frame(0);
    let receivers = ReceiverBuffer::vertices(&frame);
    common::shaded(strategy, scene, &frame, &receivers, settings)
}

fn every_channel_is_as_it_is_alone(strategy: &dyn Strategy, settings: &str, scenes: &[(&str, Scene)]) {
    for (name, scene) in scenes {
        let all = shade(strategy, settings, scene);
        for channel in 0..3 {
            let alone = shade(strategy, settings, &channel_of(scene, channel));
            for (i, (&found, &expected)) in all.channels[channel].iter().zip(&alone.channels[channel]).enumerate() {
                let error = (found - expected).abs();
                assert!(
                    error < 2e-5 * (1.0 + expected.abs()),
                    "{settings}, {name}, {channel}, {i}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn reflections_of_spheres_see_every_colour() {
    let scenes = coloured();
    for ground in ["seen", "ignored"] {
        every_channel_is_as_it_is_alone(
            &ShExp,
            &format!("bands=3,normals=4,own-directions=16,ground={ground}"),
            &scenes,
        );
    }
}

#[test]
fn published_and_clamped_reflections_see_every_colour() {
    // By turns: both read colours at the same places.
    for (first, settings) in
        ["intersections=precomputed,projection=product,walk=quadratic", "exp=shares,clamp=on"].into_iter().enumerate()
    {
        let scenes: Vec<_> = coloured().into_iter().skip(first).step_by(2).collect();
        every_channel_is_as_it_is_alone(
            &ShExp,
            &format!("bands=2,normals=4,own-directions=16,ground=seen,{settings}"),
            &scenes,
        );
    }
}

#[test]
fn direct_light_keeps_every_colour() {
    let scenes: Vec<_> = coloured().into_iter().chain(with_lamps()).collect();
    every_channel_is_as_it_is_alone(&Unshadowed, "", &scenes);
    every_channel_is_as_it_is_alone(&RayTraced, "plain,samples=8,sampling=cosine", &scenes);
}

/// A light that takes on a colour after baking colours what grey surfaces reflect.
#[test]
fn colours_may_come_later() {
    let receivers_of = |scene: &Scene| ReceiverBuffer::vertices(&scene.frame(0));
    let before = grey();
    let mut after = before.clone();
    after.environment = Environment::constant(Vec3::new(0.2, 1.0, 0.4));
    let mut baked = common::baked(&ShExp, &before, "bands=3,normals=4,own-directions=16,ground=seen");
    common::shade(baked.as_mut(), &before.frame(0), &receivers_of(&before));
    let found = common::shade(baked.as_mut(), &after.frame(0), &receivers_of(&after));
    let expected = shade(&ShExp, "bands=3,normals=4,own-directions=16,ground=seen", &after);
    assert_eq!(found, expected);
}
