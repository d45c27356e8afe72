//! The estimator's own promises: honest errors, determinism, targets, and nothing that isn't a number.

use crate::scenes::{ball, normals_around, object, on_the_ground, run, scene, square};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Mesh, Pose, RadianceBuffer, ReceiverBuffer, Scene, SphereLight,
    light::{EnvironmentMap, Sun},
    progress::Silent,
    spheres::AdjustRule,
};
use halfshade_truth::{DRAWS, Estimate, Geometry, Options, Tracer, Transport, estimate};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A ball over the ground under a spotty map, a sun, and two local lights, one of them wide.
fn everything() -> Scene {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let texels = (0..64 * 32)
        .map(|_| Vec3::from_array(std::array::from_fn(|_| rng.random_range(0.0_f32..1.0).powi(8))))
        .collect();
    let environment = Environment {
        sun: Some(Sun {
            direction: Vec3::new(1.0, 1.0, 0.3).normalize(),
            angular_radius: 0.1,
            radiance: Vec3::new(20.0, 18.0, 15.0),
        }),
        ..Environment::map(EnvironmentMap::new(64, 32, texels).unwrap())
    };
    let lights = vec![
        SphereLight { center: Vec3::new(-1.0, 1.5, 0.0), radius: 0.2, radiance: Vec3::new(0.0, 5.0, 9.0) },
        SphereLight { center: Vec3::new(0.0, 0.8, 1.5), radius: 0.7, radiance: Vec3::new(0.4, 0.1, 0.1) },
    ];
    let ground = object(square(4), Pose { scale: 4.0, ..Pose::IDENTITY });
    scene(vec![ground, ball(Vec3::new(0.0, 0.8, 0.0), 0.5)], environment, lights)
}

fn receivers() -> ReceiverBuffer {
    on_the_ground((0..49).map(|i| (-1.5 + 0.5 * (i % 7) as f32, -1.5 + 0.5 * (i / 7) as f32)))
}

fn values(buffer: &RadianceBuffer) -> Vec<f64> {
    buffer.channels.iter().flatten().map(|&v| f64::from(v)).collect()
}

#[test]
fn the_spread_over_seeds_is_the_error_reported() {
    let (scene, receivers) = (everything(), receivers());
    for (geometry, samples) in [(Geometry::Mesh, 256), (Geometry::Spheres(AdjustRule::Continuous), 1024)] {
        let runs: Vec<Estimate> = (0..24)
            .map(|seed| run(&scene, &receivers, &Options { geometry, samples, seed, ..Options::default() }))
            .collect();
        let radiance: Vec<Vec<f64>> = runs.iter().map(|run| values(&run.radiance)).collect();
        let count = radiance[0].len();
        let mut spread = 0.0;
        for i in 0..count {
            let mean = radiance.iter().map(|r| r[i]).sum::<f64>() / 24.0;
            spread += radiance.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / 23.0;
        }
        let reported = runs.iter().map(|run| run.rms_standard_error.powi(2)).sum::<f64>() / 24.0;
        // Each variance has 23 and 15 degrees of freedom; over some hundred values their ratio is known to a few percent,
        // but a few values at penumbra edges dominate.
        let ratio = (spread / count as f64 / reported).sqrt();
        assert!((0.88..1.12).contains(&ratio), "spread over reported: {ratio}");
    }
}

#[test]
fn draws_have_the_size_of_the_error_and_its_correlation_between_channels() {
    let (scene, receivers) = (everything(), receivers());
    let runs: Vec<Estimate> =
        (0..24).map(|seed| run(&scene, &receivers, &Options { samples: 256, seed, ..Options::default() })).collect();
    let sum = |buffer: &RadianceBuffer, i: usize| f64::from(buffer.at(i).element_sum());
    let (mut spread, mut drawn, mut alone, mut claimed) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..receivers.len() {
        let mean = runs.iter().map(|run| sum(&run.radiance, i)).sum::<f64>() / 24.0;
        spread += runs.iter().map(|run| (sum(&run.radiance, i) - mean).powi(2)).sum::<f64>() / 23.0;
        for run in &runs {
            assert_eq!(run.draws.len(), DRAWS);
            let count = (24 * DRAWS) as f64;
            drawn += run.draws.iter().map(|draw| sum(draw, i).powi(2)).sum::<f64>() / count;
            alone += run.draws.iter().map(|draw| f64::from(draw.at(i).length_squared())).sum::<f64>() / count;
            claimed += f64::from(run.standard_error.at(i).length_squared()) / 24.0;
        }
    }
    // Sums over channels show the correlation.
    let ratio = (spread / drawn).sqrt();
    assert!((0.85..1.15).contains(&ratio), "spread of sums over drawn: {ratio}");
    assert!((0.95..1.05).contains(&(claimed / alone).sqrt()), "{claimed} {alone}");
    // Under grey light all channels are one: their sum has nine times the variance of each.
    let grey = Scene { environment: Environment::constant(Vec3::ONE), lights: Vec::new(), ..everything() };
    let estimate = run(&grey, &receivers, &Options { samples: 256, ..Options::default() });
    let over = |of: &dyn Fn(Vec3) -> f32| -> f64 {
        estimate.draws.iter().flat_map(|draw| (0..draw.len()).map(|i| f64::from(of(draw.at(i))))).sum()
    };
    let (together, apart) = (over(&|draw| draw.element_sum().powi(2)), over(&|draw| draw.length_squared()));
    assert!(apart > 0.0 && (together / apart - 3.0).abs() < 1e-3, "{together} {apart}");
    // Exact answers draw nothing, and unshadowed radiance is told receiver by receiver.
    let free = run(&scene, &receivers, &Options { transport: Transport::Unshadowed, ..Options::default() });
    assert!(free.draws.is_empty());
    let mean = free.unshadowed.iter().map(|value| f64::from(*value)).sum::<f64>() / free.unshadowed.len() as f64;
    assert!((mean / free.unshadowed_mean - 1.0).abs() < 1e-6 && free.unshadowed.len() == receivers.len());
}

#[test]
fn a_noise_target_is_reached_and_is_kept_by_a_fresh_seed() {
    let (scene, receivers) = (everything(), receivers());
    let reference = run(&scene, &receivers, &Options { samples: 1 << 15, seed: 77, ..Options::default() });
    let options = Options { samples: 64, noise_target: Some(2e-3), ..Options::default() };
    let estimate = run(&scene, &receivers, &options);
    assert!(estimate.relative_rms_standard_error() <= 2e-3 && estimate.samples > 64);
    let (a, b) = (values(&estimate.radiance), values(&reference.radiance));
    let rms = (a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt();
    assert!(rms < 1.4 * 2e-3 * reference.unshadowed_mean, "{rms}");
    let capped = run(&scene, &receivers, &Options { noise_target: Some(1e-9), max_samples: 512, ..options });
    assert_eq!(capped.samples, 512);
}

#[test]
fn threads_and_batches_change_no_bit() {
    let (scene, receivers) = (everything(), receivers());
    let tracer = Tracer::new(&scene.frame(0));
    for geometry in [Geometry::Mesh, Geometry::Spheres(AdjustRule::Continuous)] {
        let options = Options { geometry, samples: 128, seed: 3, ..Options::default() };
        let many = estimate(&tracer, receivers.view(), &options, &Silent);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let single = one.install(|| estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &options, &Silent));
        assert_eq!(many, single);
        for range in [0..1, 5..18, 40..49] {
            let part = estimate(&tracer, receivers.view().slice(range.clone()), &options, &Silent);
            for (place, i) in range.enumerate() {
                assert_eq!(part.radiance.at(place), many.radiance.at(i));
                assert_eq!(part.standard_error.at(place), many.standard_error.at(i));
            }
        }
        let other = estimate(&tracer, receivers.view(), &Options { seed: 4, ..options }, &Silent);
        assert_ne!(many.radiance, other.radiance);
    }
}

#[test]
fn light_scales_and_black_stays_black() {
    let receivers = receivers();
    let at = |light: f32| {
        let objects = vec![ball(Vec3::Y, 0.5)];
        let lights = vec![SphereLight { center: Vec3::splat(2.0), radius: 0.3, radiance: Vec3::splat(light) }];
        let map = EnvironmentMap::new(8, 4, (0..32).map(|i| Vec3::splat(light * (i % 5) as f32)).collect()).unwrap();
        let mut environment = Environment::map(map);
        environment.sun = Some(Sun { direction: Vec3::Y, angular_radius: 0.01, radiance: Vec3::splat(light) });
        run(&scene(objects, environment, lights), &receivers, &Options { samples: 256, ..Options::default() })
    };
    let unit = at(1.0);
    for light in [1e-6_f32, 1e6] {
        for (scaled, one) in values(&at(light).radiance).iter().zip(values(&unit.radiance)) {
            assert!((scaled / f64::from(light) - one).abs() < 1e-5 * one.abs().max(1e-3), "{scaled} {one}");
        }
    }
    let black = at(0.0);
    assert!(values(&black.radiance).iter().chain(&values(&black.standard_error)).all(|&v| v == 0.0));
    assert_eq!((black.rays, black.relative_rms_standard_error()), (0, 0.0));
}

#[test]
fn strange_input_gives_numbers() {
    let mut strange = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)],
        normals: vec![Vec3::Y; 6],
        triangles: vec![[0, 1, 2], [0, 0, 0], [0, 1, 4], [0, 3, 5], [0, 1, 99]],
        ..Mesh::default()
    };
    let sky = Environment::constant(Vec3::ONE);
    let mut receivers = on_the_ground([(0.0, 0.0), (f32::NAN, 0.0), (1e30, -1e30)]);
    receivers.push(Vec3::ZERO, Vec3::ZERO, Vec3::ONE, 0);
    receivers.push(Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::ONE, 0);
    let light = SphereLight { center: Vec3::ZERO, radius: 1e-30, radiance: Vec3::ONE };
    let huge = SphereLight { center: Vec3::ZERO, radius: 1e30, radiance: Vec3::ONE };
    for triangles in [vec![], vec![[0, 1, 3]], vec![[0, 1, 3], [0, 3, 1], [1, 2, 3]]] {
        strange.triangles.truncate(5);
        strange.triangles.extend(triangles);
        let scene = scene(vec![object(strange.clone(), Pose::IDENTITY)], sky.clone(), vec![light, huge]);
        for transport in [Transport::Shadowed, Transport::Unshadowed] {
            for geometry in [Geometry::Mesh, Geometry::Spheres(AdjustRule::Published)] {
                let options = Options { samples: 64, geometry, transport, ..Options::default() };
                let estimate = run(&scene, &receivers, &options);
                assert!(values(&estimate.radiance).iter().all(|v| v.is_finite() && *v >= 0.0));
                assert!(values(&estimate.standard_error).iter().all(|v| v.is_finite() && *v >= 0.0));
            }
        }
    }
    let nobody = run(&scene(vec![], sky, vec![]), &ReceiverBuffer::default(), &Options::default());
    assert!(nobody.radiance.is_empty() && nobody.rms_standard_error == 0.0 && nobody.unshadowed_mean == 0.0);
}

#[test]
fn hits_interpolate_the_surface() {
    let scene = scene(vec![ball(Vec3::new(0.0, 0.5, 0.0), 0.5)], Environment::constant(Vec3::ONE), vec![]);
    let frame = scene.frame(0);
    let tracer = Tracer::new(&frame);
    for (i, direction) in normals_around(DVec3::Y, 3.1, 300).into_iter().enumerate() {
        // From near and from so far away that single precision could not tell the ball's place.
        let distance = if i % 2 == 0 { 1.0 } else { 3e4 };
        let eye = (DVec3::new(0.0, 0.5, 0.0) + distance * direction).as_vec3();
        let towards = (Vec3::new(0.0, 0.5, 0.0) - eye).normalize();
        let hit = tracer.closest_hit(eye, towards).expect("the ball is in the way");
        let surface = tracer.receiver_at(&hit, towards);
        assert!((hit.distance - (distance - 0.5)).abs() < 1e-6 * distance.max(100.0), "{}", hit.distance);
        assert!((surface.position.distance(Vec3::new(0.0, 0.5, 0.0)) - 0.5).abs() < 1e-3);
        assert!(surface.normal.dot(direction.as_vec3()) > 0.99 && tracer.occluded(eye, towards));
        assert!(tracer.closest_hit(eye, -towards).is_none() && !tracer.occluded(eye, -towards));
    }
    assert_eq!(tracer.primary_hits(&scene.camera).len(), 16 * 12);
    assert!(tracer.closest_hit(Vec3::NAN, Vec3::Y).is_none() && tracer.closest_hit(Vec3::ZERO, Vec3::ZERO).is_none());
}
