//! Products of closed forms: exact for one sphere, and how far off for many.

use crate::{
    common::shaded,
    sphere_scenes::{disc, error, receivers, scene, seen_by_quadrature, sky, sphere_scenes},
};
use glam::Vec3;
use halfshade_scene::{Environment, RadianceBuffer, ReceiverBuffer, Scene, Sphere};
use halfshade_strategies::{Analytic, Unshadowed};

fn found(scene: &Scene, receivers: &ReceiverBuffer) -> [RadianceBuffer; 2] {
    let frame = scene.frame(0);
    // Receivers lie on the object that the spheres are.
    let found = shaded(&Analytic, scene, &frame, receivers, "own=spheres");
    [found, shaded(&Unshadowed, scene, &frame, receivers, "")]
}

fn error_of(environment: Environment, spheres: &[Sphere]) -> f64 {
    let (scene, receivers) = (scene(environment, spheres), receivers(400));
    let seen = seen_by_quadrature(&scene, spheres, &receivers);
    let [found, unshadowed] = found(&scene, &receivers);
    error(&found, &unshadowed, &seen)
}

#[test]
fn one_sphere_under_a_constant_sky_is_exact() {
    let receivers = receivers(500);
    for radius in [0.02, 0.5, 0.99] {
        let sphere = Sphere { center: Vec3::new(0.2, 1.0, -0.1), radius };
        let [found, _] = found(&scene(sky(), &[sphere]), &receivers);
        for i in 0..receivers.len() {
            let offset = (sphere.center - receivers.view().position_at(i)).as_dvec3();
            let exact = 1.0 - f64::from(radius * radius) / offset.length_squared() * offset.y / offset.length();
            assert!((f64::from(found.at(i).x) - exact).abs() < 1e-5, "{radius}: {} {exact}", found.at(i).x);
        }
    }
}

/// The part of a disc's solid angle is exact; the cosine's differences within 30 degrees are left out.
#[test]
fn one_sphere_before_a_disc_errs_by_the_cosine_alone() {
    let sphere = Sphere { center: Vec3::new(0.2, 1.0, -0.1), radius: 0.4 };
    let error = error_of(disc(), &[sphere]);
    assert!(error < 6e-3, "{error}");
}

/// The failure by which the method is known: spheres that overlap hide the same light many times.
#[test]
fn many_spheres_that_overlap_are_far_too_dark() {
    for (light, environment, bounds) in
        [("sky", sky(), [0.25, 0.45, 0.1, 0.15]), ("disc", disc(), [0.15, 0.15, 0.1, 0.15])]
    {
        for (case, bound) in sphere_scenes().iter().zip(bounds) {
            let error = error_of(environment.clone(), &case.spheres);
            assert!(error < bound, "{light}, {}: {error}", case.name);
        }
    }
    let crowded = &sphere_scenes()[1];
    assert!(error_of(sky(), &crowded.spheres) > 0.1);
}
