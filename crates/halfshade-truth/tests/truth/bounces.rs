//! Interreflection: closed forms with a known number of bounces, and the estimator's promises with bounces on.

use crate::scenes::{assert_agrees, ball, icosphere, normals_around, object, on_the_ground, room, run, scene, square};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Mesh, Object, Pose, ReceiverBuffer, Scene, SphereLight,
    builtin::shapes,
    light::{EnvironmentMap, Sun},
    progress::Silent,
    spheres::AdjustRule,
};
use halfshade_truth::{Estimate, Geometry, Options, Tracer, estimate};
use std::{f64::consts::PI, sync::Arc};

const SPHERES: Geometry = Geometry::Spheres(AdjustRule::Continuous);
const BLACK: Environment = Environment::constant(Vec3::ZERO);

fn with_albedo(object: Object, albedo: Vec3) -> Object {
    object.albedo(albedo)
}

fn bounced(bounces: usize, samples: usize) -> Options {
    Options { bounces, samples, ..Options::default() }
}

#[test]
fn a_convex_object_under_constant_light_reflects_its_albedo() {
    let (albedo, sky) = (Vec3::new(1.0, 0.5, 0.1), Vec3::new(1.0, 2.0, 3.0));
    // The room's walls seen from outside: their normals turned.
    let mut cuboid = room();
    cuboid.normals.iter_mut().for_each(|normal| *normal = -*normal);
    for mesh in [icosphere(4), cuboid] {
        for scale in [1e-3, 1.0, 1e3] {
            let pose = Pose { scale, ..Pose::from_translation(scale * Vec3::new(0.2, 3.0, -1.0)) };
            let scene =
                scene(vec![with_albedo(object(mesh.clone(), pose), albedo)], Environment::constant(sky), vec![]);
            let receivers = ReceiverBuffer::vertices(&scene.frame(0));
            for bounces in [1, 4] {
                let estimate = run(&scene, &receivers, &bounced(bounces, 64));
                for i in 0..receivers.len() {
                    assert!(estimate.radiance.at(i).distance(albedo * sky) < 1e-5, "{i} {}", estimate.radiance.at(i));
                }
            }
        }
    }
}

/// The inside of a sphere of radius 1 with a light in its centre: each bounce adds the albedo times the one before.
#[test]
fn the_inside_of_a_sphere_gives_the_geometric_series() {
    let mesh = icosphere(5);
    for albedo in [0.0_f32, 0.5, 1.0] {
        let light = SphereLight { center: Vec3::ZERO, radius: 0.1, radiance: Vec3::splat(100.0) };
        let mut walls = mesh.clone();
        walls.normals.iter_mut().for_each(|normal| *normal = -*normal);
        let walls = with_albedo(object(walls, Pose::IDENTITY), Vec3::splat(albedo));
        let scene = scene(vec![walls], BLACK, vec![light]);
        let mut receivers = ReceiverBuffer::default();
        for normal in normals_around(DVec3::Y, 3.1, 60) {
            // Just inside the facets, whose middles lie up to 2e-4 inside the sphere.
            receivers.push(0.999 * normal.as_vec3(), -normal.as_vec3(), Vec3::ONE, 0);
        }
        let direct = (0.1_f64 / 0.999).powi(2) * 100.0;
        for bounces in 0..=4 {
            let series: f64 = (1..=bounces).map(|b| f64::from(albedo).powi(b as i32)).sum();
            let estimate = run(&scene, &receivers, &bounced(bounces, 256));
            // Per bounce, walls are brighter than the receiver would be in their place by the facets' distance.
            let walls = 100.0 * 0.01;
            assert_agrees(&estimate, |_| direct + walls * series, 1e-2, 1e-3 + 5e-4 * series);
        }
    }
}

/// A plate of 2 by 2 at y = 0 under a sun at the zenith, seen from receivers that face down on it from `height`.
fn over_a_lit_plate(plate: Object, bounces: usize) -> (Estimate, Vec<DVec3>) {
    let sun = Sun { direction: Vec3::Y, angular_radius: 0.01, radiance: Vec3::splat(1.0 / 1e-4) };
    let scene = scene(vec![plate], Environment { sun: Some(sun), ..BLACK }, vec![]);
    let (mut receivers, mut places) = (ReceiverBuffer::default(), Vec::new());
    for i in 0..100 {
        let place = Vec3::new(-0.9 + 0.2 * (i % 10) as f32, 0.6, -0.9 + 0.2 * (i / 10) as f32);
        receivers.push(place, Vec3::NEG_Y, Vec3::ONE, 0);
        places.push(place.as_dvec3());
    }
    (run(&scene, &receivers, &bounced(bounces, 4096)), places)
}

/// Lambert's form factor from a point that faces down to the square |x|, |z| ≤ 1, y = 0.
fn form_factor(at: DVec3) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| DVec3::new(x, 0.0, z) - at);
    let sum: f64 = (0..4)
        .map(|k| {
            let (a, b) = (corners[k].normalize(), corners[(k + 1) % 4].normalize());
            a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().y
        })
        .sum();
    sum.abs() / (2.0 * PI)
}

#[test]
fn a_lit_plate_reflects_its_form_factor() {
    let irradiance = PI * 0.01_f64.sin().powi(2) / 1e-4;
    let albedo = Vec3::new(0.7, 0.2, 0.0);
    for bounces in [1, 3] {
        let plate = with_albedo(object(square(3), Pose::IDENTITY), albedo);
        let (estimate, places) = over_a_lit_plate(plate, bounces);
        let expected = |i: usize| f64::from(albedo.x) * irradiance / PI * form_factor(places[i]);
        assert_agrees(&estimate, expected, 2e-3, 1e-6);
        for i in 0..places.len() {
            let [red, green, blue] = estimate.radiance.at(i).to_array();
            assert!((green - red * 0.2 / 0.7).abs() < 1e-5 && blue == 0.0, "{i}: {red} {green} {blue}");
        }
    }
    let (dark, _) = over_a_lit_plate(object(square(3), Pose::IDENTITY), 0);
    assert!(dark.radiance.channels.iter().flatten().all(|&value| value == 0.0));
}

#[test]
fn colours_of_vertices_are_interpolated_where_a_path_meets_them() {
    // A ramp from 0 at x = -1 to 1 at x = 1: for the middle receivers as bright as its mean, by symmetry.
    let mut plate = square(4);
    plate.colors = plate.positions.iter().map(|p| Vec3::new(0.5 + 0.5 * p.x, 0.5, 0.5 - 0.5 * p.x)).collect();
    let plate = with_albedo(object(plate, Pose::IDENTITY), Vec3::splat(0.8));
    let (estimate, places) = over_a_lit_plate(plate, 1);
    for (i, place) in places.iter().enumerate() {
        let [red, green, blue] = estimate.radiance.at(i).as_dvec3().to_array();
        let error = f64::from(estimate.standard_error.at(i).max_element());
        assert!((red + blue - 2.0 * green).abs() < 1e-5, "the ramps add up: {red} {green} {blue}");
        assert!((red - blue) * place.x > 0.0 && error < 2e-3);
    }
    let mirrored: f64 = (0..100)
        .map(|i| f64::from(estimate.radiance.at(i).x) - f64::from(estimate.radiance.at(i / 10 * 10 + 9 - i % 10).z))
        .sum();
    assert!(mirrored.abs() / 100.0 < 5e-4, "{mirrored}");
}

/// A patch faces a disc of radius R at height h, lit from above by a constant sky that the disc hides from the patch:
/// one bounce gives albedo · E/π · R²/(R² + h²), the form factor from a small parallel patch to a coaxial disc.
#[test]
fn a_disc_lights_a_patch_by_its_form_factor() {
    let albedo = Vec3::new(0.8, 0.4, 0.2);
    let mut disc = shapes::plane(64);
    disc.positions.iter_mut().for_each(|p| {
        // The square onto the disc: its rings onto rings.
        let ring = p.x.abs().max(p.z.abs());
        *p *= if ring > 0.0 { ring / p.length() } else { 1.0 };
    });
    let disc = with_albedo(object(disc, Pose::IDENTITY), albedo);
    let scene = scene(vec![disc], Environment::constant(Vec3::ONE), Vec::new());
    let mut receivers = ReceiverBuffer::default();
    let heights = [0.25f32, 0.5, 1.0, 2.0];
    heights.iter().for_each(|&h| receivers.push(Vec3::new(0.0, h, 0.0), Vec3::NEG_Y, Vec3::ONE, 0));
    let found = run(&scene, &receivers, &bounced(1, 4096));
    for (i, height) in heights.into_iter().enumerate() {
        let factor = 1.0 / (1.0 + height * height);
        // The sky below that the disc doesn't hide is seen directly.
        let expected = albedo * factor + Vec3::splat(1.0 - factor);
        let allowed = 4.0 * found.standard_error.at(i) + Vec3::splat(2e-3);
        assert!((found.radiance.at(i) - expected).abs().cmple(allowed).all(), "{height}: {}", found.radiance.at(i));
    }
}

/// Colours on a sphere come from the mesh that it stands for.
#[test]
fn spheres_carry_the_colours_of_their_mesh() {
    let sky = Environment::constant(Vec3::ONE);
    let mut scene = scene(vec![ball(Vec3::new(0.0, 1.5, 0.0), 1.0)], sky, vec![]);
    let mesh = Arc::make_mut(&mut scene.objects[0].mesh);
    mesh.colors = mesh.positions.iter().map(|p| if p.x > 0.0 { Vec3::X } else { Vec3::Z }).collect();
    let receivers = on_the_ground([(-2.0, 0.0), (0.0, 0.0), (2.0, 0.3)]);
    let of = |geometry| run(&scene, &receivers, &Options { geometry, ..bounced(1, 4096) });
    let (mesh, spheres) = (of(Geometry::Mesh), of(SPHERES));
    for i in 0..receivers.len() {
        let difference = (spheres.radiance.at(i) - mesh.radiance.at(i)).abs().max_element();
        assert!(difference < 0.01, "{i}: {difference}");
    }
    assert!(spheres.radiance.at(2).x > spheres.radiance.at(2).z + 0.05);
}

/// Under a constant sky a single sphere is as bright as its albedo all over, by itself convex.
#[test]
fn a_sphere_in_the_sky_reflects_as_mesh_and_as_sphere() {
    let (center, radius, albedo) = (Vec3::new(0.1, 1.0, -0.2), 0.6, 0.4);
    let sky = Environment::constant(Vec3::ONE);
    let scene = scene(vec![with_albedo(ball(center, radius), Vec3::splat(albedo))], sky, vec![]);
    let points: Vec<(f32, f32)> = (0..64).map(|i| (-1.4 + 0.4 * (i % 8) as f32, -1.4 + 0.4 * (i / 8) as f32)).collect();
    let receivers = on_the_ground(points);
    let expected = |i: usize| {
        let offset = center.as_dvec3() - receivers.view().position_at(i).as_dvec3();
        let form_factor = f64::from(radius).powi(2) / offset.length_squared() * offset.normalize().y;
        1.0 - form_factor * (1.0 - f64::from(albedo))
    };
    for bounces in [1, 2] {
        for (geometry, model_error) in [(Geometry::Mesh, 3e-5), (SPHERES, 1e-6)] {
            let estimate = run(&scene, &receivers, &Options { geometry, ..bounced(bounces, 2048) });
            assert_agrees(&estimate, expected, 4e-3, model_error);
        }
    }
}

/// Two balls of different colours beside each other under a map, a sun and a local light.
fn two_balls(scale: f32) -> Scene {
    let texels = (0..32 * 16).map(|i| Vec3::new((i % 5) as f32, (i % 3) as f32, 1.0)).collect();
    let sun = Sun { direction: Vec3::new(1.0, 1.0, 0.3).normalize(), angular_radius: 0.1, radiance: Vec3::splat(20.0) };
    let environment = Environment { sun: Some(sun), ..Environment::map(EnvironmentMap::new(32, 16, texels).unwrap()) };
    let light = SphereLight { center: scale * Vec3::new(-1.5, 1.5, 0.5), radius: 0.3 * scale, radiance: Vec3::ONE };
    let balls = [(Vec3::new(-0.6, 0.8, 0.0), Vec3::new(0.9, 0.1, 0.1)), (Vec3::new(0.6, 0.7, 0.1), Vec3::ONE)]
        .map(|(center, albedo)| with_albedo(ball(scale * center, 0.5 * scale), albedo));
    scene(balls.into(), environment, vec![light])
}

fn ground(scale: f32) -> ReceiverBuffer {
    on_the_ground((0..36).map(|i| (scale * (-1.3 + 0.5 * (i % 6) as f32), scale * (-1.3 + 0.5 * (i / 6) as f32))))
}

#[test]
fn spheres_and_meshes_agree_on_everything_at_once_at_every_scale() {
    let reference = run(&two_balls(1.0), &ground(1.0), &bounced(2, 4096));
    let direct = run(&two_balls(1.0), &ground(1.0), &bounced(0, 4096));
    for (geometry, scale) in [(SPHERES, 1.0), (SPHERES, 1e-3), (Geometry::Mesh, 1e-3), (Geometry::Mesh, 1e3)] {
        let estimate = run(&two_balls(scale), &ground(scale), &Options { geometry, seed: 5, ..bounced(2, 4096) });
        let (mut squares, mut variance, mut gained) = (0.0, 0.0, 0.0);
        for i in 0..36 {
            squares += f64::from(estimate.radiance.at(i).distance_squared(reference.radiance.at(i)));
            variance += f64::from(
                estimate.standard_error.at(i).length_squared() + reference.standard_error.at(i).length_squared(),
            );
            gained += f64::from((estimate.radiance.at(i) - direct.radiance.at(i)).length_squared());
        }
        assert!(squares < 2.0 * variance, "{geometry:?} {scale}: {squares} {variance}");
        assert!(gained > 100.0 * variance, "bounces are a small part of nothing: {gained} {variance}");
    }
}

#[test]
fn black_surfaces_reflect_nothing_whatever_is_asked() {
    let mut scene = two_balls(1.0);
    scene.objects.iter_mut().for_each(|object| object.material.albedo = Vec3::ZERO);
    for geometry in [Geometry::Mesh, SPHERES] {
        let of = |bounces| run(&scene, &ground(1.0), &Options { geometry, ..bounced(bounces, 256) }).radiance;
        for (a, b) in of(0).channels.iter().flatten().zip(of(3).channels.iter().flatten()) {
            assert_eq!(a, b);
        }
    }
}

#[test]
fn the_spread_over_seeds_is_the_error_reported_and_targets_are_met() {
    let (scene, receivers) = (two_balls(1.0), ground(1.0));
    let runs: Vec<Estimate> =
        (0..24).map(|seed| run(&scene, &receivers, &Options { seed, ..bounced(2, 128) })).collect();
    let mut spread = 0.0;
    for i in 0..receivers.len() {
        let mean = runs.iter().map(|run| run.radiance.at(i).as_dvec3()).sum::<DVec3>() / 24.0;
        spread += runs.iter().map(|run| (run.radiance.at(i).as_dvec3() - mean).length_squared()).sum::<f64>() / 23.0;
    }
    let reported = runs.iter().map(|run| run.rms_standard_error.powi(2)).sum::<f64>() / 24.0;
    let ratio = (spread / (3 * receivers.len()) as f64 / reported).sqrt();
    assert!((0.88..1.12).contains(&ratio), "spread over reported: {ratio}");
    let target = Options { noise_target: Some(2e-3), ..bounced(2, 64) };
    assert!(run(&scene, &receivers, &target).relative_rms_standard_error() <= 2e-3);
}

#[test]
fn threads_and_batches_change_no_bit_of_a_bounce() {
    let (scene, receivers) = (two_balls(1.0), ground(1.0));
    let tracer = Tracer::new(&scene.frame(0));
    for geometry in [Geometry::Mesh, SPHERES] {
        let options = Options { geometry, ..bounced(2, 64) };
        let many = estimate(&tracer, receivers.view(), &options, &Silent);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let single = one.install(|| estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent));
        assert_eq!(many, single);
        let part = estimate(&tracer, receivers.view().slice(7..19), &options, &Silent);
        assert!((7..19).all(|i| part.radiance.at(i - 7) == many.radiance.at(i)));
    }
}

#[test]
fn what_is_degenerate_stays_finite() {
    let mut flat = square(2);
    flat.normals.iter_mut().for_each(|normal| *normal = Vec3::ZERO);
    flat.triangles.push([0, 1, 0]);
    let bare = object(Mesh::default(), Pose::IDENTITY);
    let mut twins = two_balls(1.0);
    // The same ball twice, one on top of the other, and one whose set has no mesh.
    twins.objects = vec![twins.objects[0].clone(), twins.objects[0].clone(), object(flat, Pose::IDENTITY), bare];
    twins.objects.push(Object { mesh: Arc::new(Mesh::default()), ..ball(Vec3::Y, 0.7) });
    let inside = on_the_ground([(-0.6, 0.0), (0.0, 0.0)]);
    let mut receivers = ReceiverBuffer::vertices(&twins.frame(0));
    for i in 0..inside.len() {
        receivers.push(inside.view().position_at(i) + 0.8 * Vec3::Y, Vec3::Y, Vec3::ONE, 0);
    }
    let view = receivers.view();
    let receivers = view.slice(view.len() - 40..view.len());
    for geometry in [Geometry::Mesh, SPHERES] {
        let tracer = Tracer::new(&twins.frame(0));
        let estimate = estimate(&tracer, receivers, &Options { geometry, ..bounced(16, 64) }, &Silent);
        assert!(estimate.radiance.channels.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
        assert!(estimate.standard_error.channels.iter().flatten().all(|v| v.is_finite()));
    }
}
