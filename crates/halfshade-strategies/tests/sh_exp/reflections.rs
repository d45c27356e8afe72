//! Reflections of SH exponentiation against closed forms, and its variants against each other.

use crate::{built_scenes::VASES, common::shaded};
use glam::{DVec3, Quat, Vec3};
use halfshade_scene::{
    Environment, Frame, Material, Motion, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereSet,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
};
use halfshade_strategies::sh_exp::ShExp;
use std::{f64::consts::PI, sync::Arc};

fn ball(center: Vec3, radius: f32, albedo: Vec3) -> Object {
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    Object::new("ball", shapes::sphere(20))
        .albedo(albedo)
        .spheres(set)
        .cluster_count(1)
        .pose(Pose { scale: radius, ..Pose::from_translation(center) })
}

fn scene(objects: Vec<Object>, bounces: usize) -> Scene {
    Scene { bounces, ..Scene::at_rest("test", objects, Environment::constant(Vec3::ONE)) }
}

fn shade(scene: &Scene, frame: &Frame<'_>, receivers: &ReceiverBuffer, settings: &str) -> RadianceBuffer {
    shaded(&ShExp, scene, frame, receivers, settings)
}

/// White receivers on the ground, on a line.
fn line() -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    (0..40).for_each(|i| receivers.push(Vec3::new(0.1 * i as f32, 0.0, 0.03), Vec3::Y, Vec3::ONE, 0));
    receivers
}

fn largest_difference(a: &RadianceBuffer, b: &RadianceBuffer) -> f32 {
    let pairs = a.channels.iter().flatten().zip(b.channels.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// A ball that sees nothing but the sky radiates its albedo everywhere: the ground gets back that share of what it lost,
/// exactly if what is lost and what is given back come from the same exponential.
#[test]
fn a_ball_under_a_constant_sky_gives_back_its_albedo() {
    let albedo = Vec3::new(1.0, 0.5, 0.1);
    for bounces in [1, 3] {
        let scene = scene(vec![ball(Vec3::new(0.0, 1.3, 0.0), 1.0, albedo)], bounces);
        for settings in
            ["", "intersections=ordered,order=power", "projection=product,form-factor=cosine", "walk=quadratic"]
        {
            let shadow = shade(&scene, &scene.frame(0), &line(), &format!("bounces=0,{settings}"));
            let all = shade(
                &scene,
                &scene.frame(0),
                &line(),
                &format!("reflection-exp=hybrid,reflection-limit=0,{settings}"),
            );
            for i in 0..shadow.len() {
                let expected = shadow.at(i) + albedo * (Vec3::ONE - shadow.at(i));
                let error = (all.at(i) - expected).abs().max_element();
                assert!(error < 2e-3, "{settings}: {} instead of {expected}", all.at(i));
            }
            let published_limit = shade(&scene, &scene.frame(0), &line(), settings);
            let difference = largest_difference(&all, &published_limit);
            assert!(difference < 0.04, "{settings}: {difference}");
        }
    }
}

/// Light that a white ball of radius 0.5 under a sky alone reflects onto the ground below, `∫ (1 + p_y)/2 max(n·ω, 0) dω/π` over
/// the directions in which it is seen.
fn sky_lit(receiver: DVec3, center: DVec3) -> f64 {
    let (offset, radius) = (center - receiver, 0.5);
    let distance = offset.length();
    let axis = offset / distance;
    let (u, v) = axis.any_orthonormal_pair();
    let (sine, steps) = (radius / distance, 160);
    let mut sum = 0.0;
    for ring in 0..steps {
        let t = 0.5 * PI * (f64::from(ring) + 0.5) / f64::from(steps);
        let sin_b = sine * t.sin();
        let cos_b = (1.0 - sin_b * sin_b).sqrt();
        // sin β dβ, with sin β = sin θ sin t.
        let measure = 0.5 * PI / f64::from(steps) * sine * t.cos() * sin_b / cos_b;
        for spoke in 0..steps {
            let (sin, cos) = (2.0 * PI * (f64::from(spoke) + 0.5) / f64::from(steps)).sin_cos();
            let direction = cos_b * axis + sin_b * (cos * u + sin * v);
            let along = distance * cos_b - radius * t.cos();
            let normal = (along * direction - offset) / radius;
            sum += (1.0 + normal.y) / 2.0 * direction.y.max(0.0) * measure * 2.0 * PI / f64::from(steps);
        }
    }
    sum / PI
}

/// The mean over the ground around a ball, of a sky: with the receiver's cosine within 3 %, without it 7 to 16 % too dark. Where the
/// ground cuts the ball three quarters arrive, since the rule for cut spheres makes them smaller; without it half.
#[test]
fn a_ball_lit_by_a_sky_reflects_what_it_should() {
    let texels = (0..64 * 32).map(|i| Vec3::splat(if i < 64 * 16 { 1.0 } else { 0.0 })).collect();
    let sky = EnvironmentMap::new(64, 32, texels).unwrap();
    for (height, bounds) in [(0.55, [0.97, 1.03]), (0.7, [0.97, 1.03]), (1.5, [0.97, 1.03]), (0.3, [0.7, 1.03])] {
        let objects = vec![ball(Vec3::new(0.0, height, 0.0), 0.5, Vec3::ONE)];
        let environment = Environment { base: DistantLight::Map(Arc::new(sky.clone())), sun: None };
        let scene = Scene { bounces: 1, ..Scene::at_rest("sky", objects, environment) };
        // From just outside the ball.
        let first = (0.25 - height.min(0.5) * height.min(0.5)).max(0.0).sqrt();
        let mut receivers = ReceiverBuffer::default();
        let places: Vec<f32> = (1..=60).map(|i| first + 0.05 * i as f32).collect();
        places.iter().for_each(|&x| receivers.push(Vec3::new(x, 0.0, 0.0), Vec3::Y, Vec3::ONE, 1));
        let reflected = |settings: &str| {
            let [all, direct] = ["", "bounces=0,"]
                .map(|bounces| shade(&scene, &scene.frame(0), &receivers, &format!("{bounces}{settings}")));
            places.iter().enumerate().map(|(i, &x)| f64::from(x * (all.at(i).y - direct.at(i).y))).sum::<f64>()
        };
        let center = DVec3::new(0.0, f64::from(height), 0.0);
        let exact: f64 =
            places.iter().map(|&x| f64::from(x) * sky_lit(DVec3::new(f64::from(x), 0.0, 0.0), center)).sum();
        let [found, plain] = ["average=receiver", "average=sphere"].map(|settings| reflected(settings) / exact);
        assert!(found > bounds[0] && found < bounds[1], "{height}: {found}");
        assert!(plain < 0.93, "{height}: {plain}");
    }
}

/// A small ball far above wide ground under a constant sky: half a sphere of sky, half a sphere of what ground gives back.
#[test]
fn a_ball_over_wide_ground_sees_it_instead_of_the_sky_below() {
    for (scale, turn) in [(1.0, 0.0), (1e3, 0.4)] {
        let ground_albedo = Vec3::new(0.8, 0.4, 0.0);
        let tilt = Quat::from_rotation_z(turn);
        let ground = Object {
            name: "ground".into(),
            mesh: Arc::new(shapes::plane(8)),
            material: Material::new(ground_albedo),
            sphere_count: 0,
            spheres: None,
            motion: Motion::Still(Pose { scale: 2e3 * scale, rotation: tilt, translation: Vec3::ZERO }),
            ..ball(Vec3::ZERO, 1.0, Vec3::ONE)
        };
        let up = tilt * Vec3::Y;
        let scene = scene(vec![ground, ball(2.0 * scale * up, 0.05 * scale, Vec3::ONE)], 1);
        let frame = scene.frame(0);
        let receivers = ReceiverBuffer::vertices(&frame);
        for (bounces, directions, bound) in [(0, 128, 0.025), (1, 128, 0.025), (0, 1024, 0.006), (1, 1024, 0.006)] {
            let settings = format!("ground=seen,bounces={bounces},ground-directions={directions}");
            let found = shade(&scene, &frame, &receivers, &settings);
            let ignored = shade(&scene, &frame, &receivers, &format!("bounces={bounces}"));
            for i in 0..receivers.len() {
                if receivers.object[i] == 0 {
                    // The ground doesn't see itself; the ball above it is a little darker below.
                    assert!((found.at(i) - ignored.at(i)).abs().max_element() < 2e-3);
                    continue;
                }
                let toward_ground = 0.5 * (1.0 - receivers.view().normal_at(i).dot(up));
                let from_ground = if bounces == 0 { Vec3::ZERO } else { ground_albedo };
                let expected = Vec3::ONE + toward_ground * (from_ground - Vec3::ONE);
                let error = (found.at(i) - expected).abs().max_element();
                assert!(error < bound, "{bounces} bounces: {} instead of {expected}", found.at(i));
            }
        }
    }
}

/// The running sum less the neighbours is the sum over all others: rounding alone is between them.
#[test]
fn linear_and_quadratic_walks_agree() {
    let scene = &*VASES;
    let frame = scene.frame(7);
    let vertices = ReceiverBuffer::vertices(&frame);
    let places: Vec<u32> = (0..vertices.len() as u32).step_by(8).collect();
    let receivers = ReceiverBuffer::gathered(vertices.view(), &places);
    for settings in ["", "intersections=precomputed", "order=power", "reflection-exp=hybrid", "bands=3", "bands=6"] {
        let linear = shade(scene, &frame, &receivers, &format!("own=spheres,walk=linear,{settings}"));
        let quadratic = shade(scene, &frame, &receivers, &format!("own=spheres,walk=quadratic,{settings}"));
        let difference = largest_difference(&linear, &quadratic);
        assert!(difference < 1e-4, "{settings}: {difference}");
    }
}

/// Objects that turn and grow carry their colours along: the same world, described twice.
#[test]
fn turned_and_scaled_objects_reflect_alike() {
    let two_colours = || {
        let mut object = ball(Vec3::new(0.3, 1.4, 0.2), 0.8, Vec3::ONE);
        let mut mesh = shapes::sphere(20);
        mesh.colors = mesh.positions.iter().map(|p| if p.x > 0.2 { Vec3::X } else { Vec3::splat(0.6) }).collect();
        object.mesh = Arc::new(mesh);
        object
    };
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 0.9);
    let mut baked_in = two_colours();
    let mut mesh = (*baked_in.mesh).clone();
    mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(|v| *v = turn * *v);
    baked_in.mesh = Arc::new(mesh);
    let mut posed = two_colours();
    if let Motion::Still(pose) = &mut posed.motion {
        pose.rotation = turn;
    }
    let radiance = [baked_in, posed].map(|object| {
        let scene = scene(vec![object], 1);
        shade(&scene, &scene.frame(0), &line(), "sample-divisions=4")
    });
    // Sample directions lie differently on the surface.
    let difference = largest_difference(&radiance[0], &radiance[1]);
    assert!(difference < 5e-3, "{difference}");
    let green: f32 = radiance[0].channels[1].iter().sum();
    let red: f32 = radiance[0].channels[0].iter().sum();
    assert!(red > 1.01 * green, "{red} {green}");
}

/// Black surfaces cost nothing and change nothing.
#[test]
fn black_objects_change_no_bit() {
    let scene = scene(vec![ball(Vec3::new(0.0, 1.3, 0.0), 1.0, Vec3::ZERO)], 2);
    let shadow = shade(&scene, &scene.frame(0), &line(), "bounces=0");
    assert_eq!(shade(&scene, &scene.frame(0), &line(), ""), shadow);
}

/// Rows of receivers across the ground between the vases.
fn rows() -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    for row in 0..5 {
        for i in 0..800 {
            let place = Vec3::new(-1.9 + 3.8 * i as f32 / 800.0, 0.0, 0.3 + 0.35 * row as f32);
            receivers.push(place, Vec3::Y, Vec3::ONE, 0);
        }
    }
    receivers
}

/// Largest step between neighbours of what `coarse` adds to `fine`: borders of clusters.
fn border_step(fine: &RadianceBuffer, coarse: &RadianceBuffer) -> f32 {
    let added = |i: usize| coarse.at(i) - fine.at(i);
    let steps = (1..fine.len()).filter(|i| i % 800 != 0).map(|i| (added(i) - added(i - 1)).abs().max_element());
    steps.fold(0.0, f32::max)
}

/// A threshold of 0 leaves the leaves; coarser levels step at the borders of clusters, and ratios take most of it away, more
/// of it towards the leaves than towards the next finer level.
#[test]
fn ratios_hide_the_borders_of_clusters() {
    let scene = &*VASES;
    let frame = scene.frame(0);
    let vertices = ReceiverBuffer::vertices(&frame);
    let leaves = shade(scene, &frame, &vertices, "own=spheres");
    assert_eq!(leaves, shade(scene, &frame, &vertices, "own=spheres,levels=cluster,cut-angle=0"));
    let receivers = rows();
    for (levels, bounces) in [("cluster", 1), ("tree", 0)] {
        let of =
            |settings: &str| shade(scene, &frame, &receivers, &format!("own=spheres,bounces={bounces},{settings}"));
        let fine = of("");
        let step =
            |ratios| border_step(&fine, &of(&format!("levels={levels},cut-angle=25,branching=2,ratios={ratios}")));
        let [with, to_leaves, without] = ["shadows", "leaves", "off"].map(step);
        assert!(without > 1e-4 && with < 0.5 * without, "{levels}, {bounces} bounces: {with}, {without}");
        // A cluster's cut is one level above the leaves here, a tree's has levels between.
        let most = if levels == "tree" { 0.5 } else { 1.001 };
        assert!(to_leaves <= most * with, "{levels}, {bounces} bounces: {to_leaves}, {with}");
    }
}

/// Eq. 4.34 by experiment, over spheres that count in full as published. On the ground, where a cluster's centre and normal stand for its receivers, the ratio upside
/// down leads nearer to what the leaves reflect, by little (as printed it led away from it). On objects, whose clusters have
/// their centres inside and normals all around, either does harm or none: the default does without.
#[test]
fn ratios_of_reflections_were_decided_by_experiment() {
    let scene = &*VASES;
    let frame = scene.frame(0);
    let vertices = ReceiverBuffer::vertices(&frame);
    let reflected = |settings: &str| -> Vec<Vec3> {
        let [all, shadows] = ["", "bounces=0,"]
            .map(|it| shade(scene, &frame, &vertices, &format!("own=spheres,overlap=independent,{it}{settings}")));
        (0..all.len()).map(|i| all.at(i) - shadows.at(i)).collect()
    };
    let fine = reflected("");
    let off = |ratios| {
        let coarse = reflected(&format!("levels=cluster,cut-angle=25,branching=2,ratios={ratios}"));
        [true, false].map(|ground| {
            let squares = (fine.iter().zip(&coarse).zip(&vertices.object))
                .filter(|(_, object)| !ground || **object == 0)
                .map(|((fine, coarse), _)| f64::from((*fine - *coarse).length_squared()));
            squares.sum::<f64>().sqrt()
        })
    };
    let ([ground_none, all_none], [ground_inverted, all_inverted]) = (off("shadows"), off("on"));
    assert!(ground_inverted < ground_none, "{ground_inverted} {ground_none}");
    assert!(all_none < all_inverted, "{all_none} {all_inverted}");
}

/// A white sphere mesh of radius 1 about (0, 1.2, 0) that any spheres stand for, scaled about the origin and moved.
fn stood_for(spheres: Vec<Sphere>, albedo: f32, scale: f32, shift: Vec3) -> Scene {
    let object = Object::new("object", shapes::sphere(12))
        .albedo(Vec3::splat(albedo))
        .spheres(SphereSet { spheres, ..SphereSet::default() })
        .cluster_count(2)
        .pose(Pose { scale, ..Pose::from_translation(scale * (1.2 * Vec3::Y) + shift) });
    scene(vec![object], 3)
}

/// Spheres on a shell about the origin.
fn shell(count: usize, shell_radius: f32, radius: f32) -> Vec<Sphere> {
    let place = |i: usize| {
        let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let (sin, cos) = (2.399_963 * i as f32).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Sphere { center: shell_radius * Vec3::new(across * cos, y, across * sin), radius }
    };
    (0..count).map(place).collect()
}

/// Under a constant sky of radiance 1 nothing is ever brighter than 1, whatever it is made of and however often light
/// bounces. Band-limited visibility adds up to 0.25 to that (a receiver of twelve identical spheres) and goes down to
/// -0.05, with intersections precomputed and averages as the receiver sees them to -0.15; everything is finite.
#[test]
fn extremes_stay_finite_and_gain_no_energy() {
    let unit = Sphere { center: Vec3::ZERO, radius: 1.0 };
    let sets: [Vec<Sphere>; 6] = [
        vec![unit],
        vec![unit; 12],
        (1..=10).map(|i| Sphere { radius: 0.1 * i as f32, ..unit }).collect(),
        shell(40, 0.3, 0.8),
        // Receivers within look out through the gaps.
        shell(64, 3.0, 0.7),
        shell(512, 0.9, 0.12),
    ];
    let here = (1.0, 1.0, Vec3::ZERO);
    let elsewhere = [
        (0.0, 1.0, Vec3::ZERO),
        (1.0, 1e-3, Vec3::ZERO),
        (1.0, 1e3, Vec3::ZERO),
        (0.5, 1.0, Vec3::new(1e4, 0.0, -3e3)),
    ];
    let all_settings = [
        "",
        "spheres-alone,intersections=precomputed,walk=quadratic",
        "reflection-exp=hybrid,order=power",
        "levels=cluster,bands=3",
    ];
    let cases = sets.iter().map(|set| (set, here)).chain(elsewhere.into_iter().map(|place| (&sets[3], place)));
    for (spheres, (albedo, scale, shift)) in cases {
        let scene = stood_for(spheres.clone(), albedo, scale, shift);
        let frame = scene.frame(0);
        let mut receivers = ReceiverBuffer::vertices(&frame);
        for i in 0..60 {
            let place = scale * Vec3::new(0.06 * i as f32, 0.0, 0.02) + shift;
            receivers.push(place, Vec3::Y, Vec3::ONE, 0);
            receivers.push(place + scale * 1.2 * Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::ONE, 0);
        }
        // Baking hundreds of spheres takes seconds.
        let settings = if spheres.len() > 100 { &all_settings[2..3] } else { &all_settings };
        for settings in settings {
            let radiance = shade(&scene, &frame, &receivers, settings);
            let least = if settings.contains("precomputed") { -0.15 } else { -0.05 };
            let wrong = radiance.channels.iter().flatten().find(|&&value| !(least..1.25).contains(&value));
            assert!(wrong.is_none(), "{} spheres, {albedo}, {scale}, {settings}: {wrong:?}", spheres.len());
        }
    }
}

/// Radiance of a scene's vertices.
fn at_vertices(scene: &Scene, settings: &str) -> RadianceBuffer {
    shade(scene, &scene.frame(0), &ReceiverBuffer::vertices(&scene.frame(0)), settings)
}

/// White balls that overlap, sink into the ground and hang above it, on white ground.
fn sunken() -> Scene {
    let places: [[f32; 3]; 5] =
        [[0.0, 0.3, 0.0], [0.4, -0.2, 0.3], [0.3, 0.9, -0.5], [-2.0, 0.1, 0.4], [0.0, 0.3, 0.1]];
    let coarse = |place| Object { mesh: Arc::new(shapes::sphere(10)), ..ball(Vec3::from(place), 0.7, Vec3::ONE) };
    let mut objects: Vec<Object> = places.map(coarse).into();
    objects.push(Object {
        mesh: Arc::new(shapes::plane(8)),
        sphere_count: 0,
        spheres: None,
        ..ball(Vec3::ZERO, 4.0, Vec3::ONE)
    });
    scene(objects, 0)
}

/// The promise of `clamp=on`, whatever else is chosen.
#[test]
fn clamped_light_stays_between_nothing_and_unshadowed() {
    let dim = Environment::map(
        EnvironmentMap::new(16, 8, (0..128).map(|i| Vec3::splat(if i == 37 { 40.0 } else { 0.02 })).collect()).unwrap(),
    );
    let suns = Environment {
        sun: Some(Sun { direction: Vec3::new(0.6, 0.8, 0.0), angular_radius: 0.05, radiance: Vec3::splat(50.0) }),
        ..Environment::constant(Vec3::splat(0.1))
    };
    for environment in [Environment::constant(Vec3::ONE), dim, suns] {
        let direct = Scene { environment, ..sunken() };
        let reflected = Scene { bounces: 2, ..direct.clone() };
        for settings in [
            "exp=hybrid",
            "exp=product",
            "exp=series",
            "exp=series,scaling=off",
            "exp=optimal-linear",
            "exp=quadratic",
            "exp=shares",
            "exp=traced,directions=256",
            "overlap=shared",
            "levels=cluster",
            "levels=tree",
            "rule=published",
            "rule=covering,window=hann",
        ] {
            let bands = 4;
            let settings = format!("{settings},bands={bands},normals=4,own-directions=16,clamp=on,ground=seen");
            let open: Vec<f32> = {
                let alone = Scene { objects: vec![direct.objects[5].clone()], ..direct.clone() };
                let receivers = ReceiverBuffer::vertices(&direct.frame(0));
                shade(&alone, &alone.frame(0), &receivers, &format!("bands={bands},normals=4,own-directions=16"))
                    .channels[0]
                    .clone()
            };
            let found = at_vertices(&direct, &settings);
            for (i, (&value, &open)) in found.channels[0].iter().zip(&open).enumerate() {
                let most = open * (1.0 + 1e-5) + 1e-6;
                assert!(value >= 0.0 && value <= most, "{settings}, {i}: {value} of {open}");
            }
            if !settings.contains("tree") {
                let found = at_vertices(&reflected, &settings);
                assert!(found.channels[0].iter().all(|&value| value >= 0.0 && value.is_finite()), "{settings}");
            }
        }
    }
}

/// Poses and sun turned as scene files turn them, while light space stays where it is.
#[test]
fn turning_poses_and_sun_changes_no_more_than_rounding() {
    let axes = [Vec3::X, Vec3::Y, Vec3::new(0.48, 0.6, -0.64)];
    let sun = Sun { direction: Vec3::new(0.6, 0.8, 0.0), angular_radius: 0.05, radiance: Vec3::splat(50.0) };
    for environment in
        [Environment::constant(Vec3::ONE), Environment { sun: Some(sun), ..Environment::constant(Vec3::ZERO) }]
    {
        let straight = Scene { environment, ..sunken() };
        for settings in
            ["exp=hybrid", "exp=product", "exp=quadratic", "exp=shares", "exp=shares,points=3,bands=6", "ground=seen"]
        {
            let settings = &format!("{settings},own-directions=16");
            let before = at_vertices(&straight, settings);
            for (i, axis) in axes.into_iter().enumerate() {
                let turn = Quat::from_axis_angle(axis, 0.7 + 1.3 * i as f32);
                let mut turned = straight.clone();
                for object in &mut turned.objects {
                    let Motion::Still(pose) = object.motion else { panic!("at rest") };
                    object.motion = Motion::Still(pose.then(&Pose { rotation: turn, ..Pose::IDENTITY }));
                }
                if let Some(sun) = &mut turned.environment.sun {
                    sun.direction = turn * sun.direction;
                }
                let difference = largest_difference(&before, &at_vertices(&turned, settings));
                let strength = before.channels[0].iter().copied().fold(0.0, f32::max);
                // Points on the sun's disc stay where they are as it turns.
                let bound = if turned.environment.sun.is_some() { 0.1 } else { 2e-3 };
                assert!(difference < bound * strength, "{settings} about {axis}: {difference} of {strength}");
            }
        }
    }
}

/// Everything is linear in the light, from the least normal number to the largest that a scene's light comes to.
#[test]
fn light_scales_with_ground_and_reflections() {
    let base = Scene { bounces: 2, ..sunken() };
    let texels = |strength: f32| (0..128).map(|i| Vec3::new(1.0, 0.5, 0.1) * strength * (1 + i % 7) as f32).collect();
    let at = |strength: f32, is_map: bool, settings: &str| {
        let environment = if is_map {
            Environment::map(EnvironmentMap::new(16, 8, texels(strength)).unwrap())
        } else {
            Environment::constant(Vec3::new(1.0, 0.5, 0.1) * strength)
        };
        at_vertices(&Scene { environment, ..base.clone() }, settings)
    };
    for settings in [
        "ground=seen,normals=4,own-directions=16",
        "ground=seen,normals=4,own-directions=16,clamp=on,exp=shares",
        "bands=2,normals=4,own-directions=16,exp=product",
    ] {
        for is_map in [false, true] {
            let unit = at(1.0, is_map, settings);
            for strength in [1e-37f32, 1e30] {
                let scaled = at(strength, is_map, settings);
                for (scaled, unit) in scaled.channels.iter().flatten().zip(unit.channels.iter().flatten()) {
                    let difference = (scaled / strength - unit).abs();
                    assert!(difference < 1e-4 * (1.0 + unit.abs()), "{settings}, {strength}: {scaled} for {unit}");
                }
            }
        }
    }
}
