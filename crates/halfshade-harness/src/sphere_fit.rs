//! How good a shadow a sphere set casts: the error of its geometry alone.
//!
//! The mesh stands on a ground plane through its lowest point, under constant light of radiance 1. Receivers are the
//! centres of a grid of 64 by 64 cells on a square of 2.5 times the mesh's larger horizontal extent, about the middle of its
//! bounding box. The figure is the RMSE between the truths of the mesh and of the sphere set (each sphere adjusted to each receiver, as strategies do),
//! relative to the unshadowed radiance, which is 1, and corrected for the noise of both.

use crate::metrics::{Reference, compare};
use glam::Vec3;
use halfshade_scene::{Environment, Material, Mesh, Motion, Object, Pose, Progress, ReceiverBuffer, Scene, SphereSet};
use halfshade_truth::{Estimate, Geometry, Options, Tracer, estimate};
use std::sync::Arc;

/// Receivers along each side of the square.
pub const GRID: usize = 64;
/// Side of the square, in larger horizontal extents of the mesh.
pub const SIDE: f32 = 2.5;
/// Samples per receiver.
const SAMPLES: usize = 512;

/// Geometry-only shadow error of `set`, which was built for `mesh`. `None` for a mesh without extent.
pub fn ground_shadow_error(mesh: &Arc<Mesh>, set: &SphereSet, progress: &dyn Progress) -> Option<f64> {
    let (min, max) = mesh.bounds()?;
    let extent = max - min;
    let side = SIDE * extent.x.max(extent.z).max(1e-3 * extent.y);
    if !(side > 0.0 && side.is_finite()) {
        return None;
    }
    let object = Object {
        name: "mesh".into(),
        mesh: mesh.clone(),
        material: Material::default(),
        sphere_count: set.spheres.len(),
        spheres: Some(Arc::new(set.clone())),
        cluster_count: 0,
        motion: Motion::Still(Pose::IDENTITY),
    };
    let scene = Scene::at_rest("ground", vec![object], Environment::constant(Vec3::ONE));
    let mut receivers = ReceiverBuffer::default();
    let middle = 0.5 * (min + max);
    for i in 0..GRID * GRID {
        let along = |n: usize| side * ((n as f32 + 0.5) / GRID as f32 - 0.5);
        let position = Vec3::new(middle.x + along(i % GRID), min.y, middle.z + along(i / GRID));
        receivers.push(position, Vec3::Y, Vec3::ONE, 0);
    }
    let tracer = Tracer::new(&scene.frame(0));
    let shadow = |geometry, seed| {
        let options = Options { geometry, samples: SAMPLES, seed, ..Options::default() };
        estimate(&tracer, receivers.view(), &options, progress)
    };
    let mesh = shadow(Geometry::Mesh, 1);
    let spheres: Estimate = shadow(Geometry::Spheres(Default::default()), 2);
    let mut standard_error = mesh.standard_error;
    for (error, other) in
        standard_error.channels.iter_mut().flatten().zip(spheres.standard_error.channels.iter().flatten())
    {
        *error = error.hypot(*other);
    }
    let reference = Reference { radiance: mesh.radiance, standard_error, unshadowed_mean: mesh.unshadowed_mean };
    compare(&spheres.radiance, &reference)?.rel_rmse
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::{Sphere, builtin, progress::Silent};

    #[test]
    fn a_sphere_casts_its_own_shadow_and_a_larger_one_a_larger() {
        let mesh = Arc::new(builtin::shape("sphere").unwrap());
        let set = |radius| SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius }], ..SphereSet::default() };
        let exact = ground_shadow_error(&mesh, &set(1.0), &Silent).unwrap();
        assert!(exact < 4e-3, "{exact}");
        // Without adjustment the blocked irradiance of a sphere of radius r at height 1 over its tangent plane is
        // r²·1/d³; with r = 0.8 instead of 1 the error is 0.36/d³, d from 1 to sqrt(1 + 2·2.5²).
        let square: f64 = (0..64 * 64)
            .map(|i| {
                let along = |n: usize| 5.0 * ((n as f64 + 0.5) / 64.0 - 0.5);
                (0.36 / (1.0 + along(i % 64).powi(2) + along(i / 64).powi(2)).powf(1.5)).powi(2)
            })
            .sum();
        let expected = (square / 4096.0).sqrt();
        let smaller = ground_shadow_error(&mesh, &set(0.8), &Silent).unwrap();
        assert!((smaller / expected - 1.0).abs() < 0.05, "{smaller} against {expected}");
    }
}
