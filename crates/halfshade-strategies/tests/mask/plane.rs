//! Spheres over a plane.

use crate::{
    common::shaded,
    sphere_scenes::{disc, error, receivers, scene, seen_by_quadrature, sky, sphere_scenes},
};
use glam::Vec3;
use halfshade_scene::{RadianceBuffer, ReceiverBuffer, Scene, Sphere};
use halfshade_strategies::{Mask, Unshadowed};

fn found(scene: &Scene, receivers: &ReceiverBuffer, settings: &str) -> [RadianceBuffer; 2] {
    let frame = scene.frame(0);
    let found = shaded(&Mask, scene, &frame, receivers, settings);
    [found, shaded(&Unshadowed, scene, &frame, receivers, "")]
}

/// Errors of 64 and 256 directions, open or closed and with edges.
#[test]
fn errors_over_a_plane() {
    let receivers = receivers(400);
    for (light, environment, bounds) in [("sky", sky(), [0.025, 0.013]), ("disc", disc(), [0.013, 0.007])] {
        for case in sphere_scenes() {
            let scene = scene(environment.clone(), &case.spheres);
            let seen = seen_by_quadrature(&scene, &case.spheres, &receivers);
            for (settings, bound) in [
                ("directions=64", bounds[0]),
                ("directions=256", bounds[1]),
                // Bits alone err about twice as much.
                ("directions=64,edge=0", 1.4 * bounds[0]),
                ("directions=256,edge=0", bounds[1]),
            ] {
                let [found, unshadowed] = found(&scene, &receivers, settings);
                let error = error(&found, &unshadowed, &seen);
                assert!(error < bound, "{light}, {}, {settings}: {error}", case.name);
            }
        }
    }
}

/// One sphere wholly above the horizon takes sin²θ·cosγ of a constant sky, small ones in the mean.
#[test]
fn one_sphere_takes_its_closed_form() {
    let receivers = receivers(500);
    for (radius, settings, bound) in [
        (0.9, "directions=64", 0.02),
        (0.4, "directions=64", 0.012),
        (0.4, "directions=256", 0.004),
        (0.4, "directions=256,normals=0", 0.01),
        (0.05, "directions=64", 0.006),
    ] {
        let sphere = Sphere { center: Vec3::new(0.2, 1.0, -0.1), radius };
        let scene = scene(sky(), &[sphere]);
        let [found, _] = found(&scene, &receivers, settings);
        let (mut squares, mut hidden, mut exact) = (0.0, 0.0, 0.0);
        for i in 0..receivers.len() {
            let offset = sphere.center - receivers.view().position_at(i);
            let closed = f64::from(radius * radius / offset.length_squared() * offset.y / offset.length());
            let taken = 1.0 - f64::from(found.at(i).x);
            squares += (taken - closed).powi(2);
            hidden += taken;
            exact += closed;
        }
        let error = (squares / receivers.len() as f64).sqrt();
        assert!(error < bound, "{radius} {settings}: {error}");
        assert!((hidden / exact - 1.0).abs() < 0.06, "{radius} {settings}: {hidden} instead of {exact}");
    }
}

/// Light that nothing hides is all there; what is left of it lies between none and all of it, whatever a receiver is in.
#[test]
fn light_is_neither_made_nor_negative() {
    let receivers = receivers(60);
    let around = |y: f32, radius: f32| Sphere { center: Vec3::new(0.1, y, 0.0), radius };
    for environment in [sky(), disc()] {
        for spheres in [
            vec![],
            vec![around(0.0, 1.0)],
            vec![around(0.5, 0.6), around(0.5, 0.6), around(-0.5, 0.6)],
            vec![around(0.0, 1e-7), around(0.0, 1e7), around(3.0, 3.0)],
        ] {
            let scene = scene(environment.clone(), &spheres);
            for settings in ["", "edge=0", "rule=covering", "rule=published,directions=8", "normals=0"] {
                let [found, unshadowed] = found(&scene, &receivers, settings);
                for i in 0..receivers.len() {
                    let (found, most) = (found.at(i), unshadowed.at(i));
                    assert!(found.cmpge(Vec3::ZERO).all() && found.cmple(most * 1.00001).all(), "{found} {most}");
                    assert!(!spheres.is_empty() || (found - most).abs().max_element() < 1e-5 * most.x);
                }
            }
        }
    }
}
