//! Receivers of a plane under sets of spheres, and what they see of the light by quadrature: f64, direction by direction,
//! sharing no code with what it tests.

use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Mesh, Object, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereSet,
    light::{DistantLight, Sun},
};
use std::f64::consts::{PI, TAU};

/// Spheres above the plane y = 0.
pub(crate) struct SphereScene {
    pub(crate) name: &'static str,
    pub(crate) spheres: Vec<Sphere>,
}

/// Spheres that overlap, on a shell, and spheres apart: few and many.
pub(crate) fn sphere_scenes() -> Vec<SphereScene> {
    let shell = |count: usize, radius: f32| -> Vec<Sphere> {
        let on_shell = |i: usize| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            let (sin, cos) = (2.399_963 * i as f32).sin_cos();
            let across = (1.0 - y * y).sqrt();
            Sphere { center: Vec3::new(0.8 * across * cos, 1.3 + 0.8 * y, 0.8 * across * sin), radius }
        };
        (0..count).map(on_shell).collect()
    };
    let apart = |count: usize| -> Vec<Sphere> {
        let place = |i: usize, step: f64| (0.37 + i as f64 * step).fract() as f32;
        let one = |i: usize| Sphere {
            center: Vec3::new(
                4.0 * place(i, 0.819_172_5) - 2.0,
                0.4 + 1.4 * place(i, 0.671_043_6),
                4.0 * place(i, 0.549_700_4) - 2.0,
            ),
            radius: 0.1 + 0.2 * place(i, 0.450_312_7),
        };
        (0..count).map(one).collect()
    };
    vec![
        SphereScene { name: "16 that overlap", spheres: shell(16, 0.45) },
        SphereScene { name: "64 that overlap", spheres: shell(64, 0.25) },
        SphereScene { name: "16 apart", spheres: apart(16) },
        SphereScene { name: "40 apart", spheres: apart(40) },
    ]
}

/// A constant sky of radiance 1.
pub(crate) fn sky() -> Environment {
    Environment::constant(Vec3::ONE)
}

/// A disc of 30 degrees and radiance 1 in a black sky.
pub(crate) fn disc() -> Environment {
    let sun = Sun {
        direction: Vec3::new(0.3, 0.8, 0.2).normalize(),
        angular_radius: 15f32.to_radians(),
        radiance: Vec3::ONE,
    };
    Environment { base: DistantLight::Constant(Vec3::ZERO), sun: Some(sun) }
}

/// An object without surface that is these spheres.
pub(crate) fn scene(environment: Environment, spheres: &[Sphere]) -> Scene {
    let set = SphereSet { spheres: spheres.to_vec(), ..SphereSet::default() };
    Scene::at_rest("spheres", vec![Object::new("spheres", Mesh::default()).spheres(set)], environment)
}

/// White receivers of the plane.
pub(crate) fn receivers(count: usize) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    for i in 0..count {
        let place = |step: f64| ((i as f64 * step).fract() as f32 - 0.5) * 4.0;
        receivers.push(Vec3::new(place(0.754_877_7), 0.0, place(0.569_840_3)), Vec3::Y, Vec3::ONE, 0);
    }
    receivers
}

/// Directions with their weights: of sum 1 for a receiver of the plane that sees all of them.
fn directions(environment: &Environment) -> Vec<(DVec3, f64)> {
    let steps = 120;
    let mut all = Vec::new();
    let (axis, reach) = match environment.sun {
        Some(sun) => (sun.direction.as_dvec3().normalize(), f64::from(sun.angular_radius)),
        None => (DVec3::Y, 0.5 * PI),
    };
    let (a, b) = axis.any_orthonormal_pair();
    for ring in 0..steps {
        // Equal steps of the squared chord are equal steps of solid angle.
        let fall = (1.0 - reach.cos()) * (f64::from(ring) + 0.5) / f64::from(steps);
        let across = (fall * (2.0 - fall)).sqrt();
        for spoke in 0..2 * steps {
            let turn = TAU * (f64::from(spoke) / f64::from(2 * steps) + 0.618_034 * f64::from(ring));
            let direction = (1.0 - fall) * axis + across * (turn.cos() * a + turn.sin() * b);
            all.push((direction, direction.y.max(0.0)));
        }
    }
    let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
    all.iter().map(|(direction, weight)| (*direction, weight / sum)).collect()
}

/// The part of the light that receivers see.
pub(crate) fn seen_by_quadrature(scene: &Scene, spheres: &[Sphere], receivers: &ReceiverBuffer) -> Vec<f64> {
    let directions = directions(&scene.environment);
    let seen = |i: usize| -> f64 {
        let place = receivers.view().position_at(i).as_dvec3();
        let caps: Vec<(DVec3, f64)> = (spheres.iter())
            .map(|sphere| {
                let offset = sphere.center.as_dvec3() - place;
                let sine = f64::from(sphere.radius) / offset.length();
                (offset.normalize(), (1.0 - sine * sine).sqrt())
            })
            .collect();
        let is_open = |direction: DVec3| caps.iter().all(|(axis, cosine)| axis.dot(direction) < *cosine);
        directions.iter().filter(|(direction, _)| is_open(*direction)).map(|(_, weight)| weight).sum()
    };
    (0..receivers.len()).map(seen).collect()
}

/// Root mean square difference of radiance from `seen` times that without blockers.
pub(crate) fn error(found: &RadianceBuffer, unshadowed: &RadianceBuffer, seen: &[f64]) -> f64 {
    let off = |i: usize| (f64::from(found.channels[0][i]) / f64::from(unshadowed.channels[0][i]) - seen[i]).powi(2);
    ((0..seen.len()).map(off).sum::<f64>() / seen.len() as f64).sqrt()
}
