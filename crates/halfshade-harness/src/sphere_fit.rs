//! How good a shadow a sphere set casts, on the ground and on the object itself: the error of its geometry alone.
//!
//! The mesh stands on a ground plane through its lowest point, under constant light of radiance 1. Receivers are the
//! centres of a grid of 64 by 64 cells on a square of 2.5 times the mesh's larger horizontal extent, about the middle of
//! its bounding box. The figure is the RMSE between the truths of the mesh and of the sphere set, each sphere adjusted to
//! each receiver as strategies do, relative to the unshadowed radiance, which is 1, and corrected for the noise of both.
//!
//! The same is told of light from a disc of 30 degrees, halfway up, and of constant light on the mesh's own vertices, where an
//! object's spheres hide light from its own surface.
//!
//! Where an object rests on the ground, most of the error may lie in the few receivers under it, inside spheres that dip
//! below the plane, and depend on the rule by which those are adjusted rather than on how well they fit.

use crate::{errors::Reference, metrics::compare, weights::ReceiverWeights};
use glam::Vec3;
use halfshade_scene::{
    Environment, Mesh, Object, Progress, ReceiverBuffer, Scene, SphereSet, light::Sun, spheres::AdjustRule,
};
use halfshade_truth::{Estimate, Geometry, Options, Tracer, estimate};
use std::sync::Arc;

/// Receivers along each side of the square.
pub const GRID: usize = 64;
/// Side of the square, in larger horizontal extents of the mesh.
pub const SIDE: f32 = 2.5;
/// Samples per receiver.
const SAMPLES: usize = 512;
/// Vertices of a mesh that are asked, about.
const VERTICES: usize = 4_096;

/// Geometry-only shadow error of `set`, which was built for `mesh`, under each of `rules`. `None` for a mesh without
/// extent.
pub fn ground_shadow_errors<const N: usize>(
    mesh: &Arc<Mesh>,
    set: &SphereSet,
    rules: [AdjustRule; N],
    progress: &dyn Progress,
) -> Option<[f64; N]> {
    errors(mesh, set, Environment::constant(Vec3::ONE), &ground(mesh)?, rules, progress)
}

/// The same under a disc of light instead of a sky, by the rule that is the default.
pub fn disc_shadow_error(mesh: &Arc<Mesh>, set: &SphereSet, progress: &dyn Progress) -> Option<f64> {
    let direction = Vec3::new(1.0, std::f32::consts::SQRT_2, 1.0).normalize();
    let sun = Sun { direction, angular_radius: 15f32.to_radians(), radiance: Vec3::ONE };
    let light = Environment { sun: Some(sun), ..Environment::constant(Vec3::ZERO) };
    errors(mesh, set, light, &ground(mesh)?, [AdjustRule::default()], progress).map(|[error]| error)
}

/// Error of constant light on the mesh's own vertices, or of evenly many of them, by the rule that is the default.
pub fn own_surface_error(mesh: &Arc<Mesh>, set: &SphereSet, progress: &dyn Progress) -> Option<f64> {
    let mut receivers = ReceiverBuffer::default();
    let vertices = mesh.positions.iter().zip(&mesh.normals);
    for (position, normal) in vertices.step_by(mesh.positions.len().div_ceil(VERTICES).max(1)) {
        receivers.push(*position, *normal, Vec3::ONE, 0);
    }
    let sky = Environment::constant(Vec3::ONE);
    errors(mesh, set, sky, &receivers, [AdjustRule::default()], progress).map(|[error]| error)
}

/// The receivers of the ground under a mesh.
fn ground(mesh: &Mesh) -> Option<ReceiverBuffer> {
    let (min, max) = mesh.bounds()?;
    let extent = max - min;
    let side = SIDE * extent.x.max(extent.z).max(1e-3 * extent.y);
    if !(side > 0.0 && side.is_finite()) {
        return None;
    }
    let mut receivers = ReceiverBuffer::default();
    let middle = 0.5 * (min + max);
    for i in 0..GRID * GRID {
        let along = |n: usize| side * ((n as f32 + 0.5) / GRID as f32 - 0.5);
        let position = Vec3::new(middle.x + along(i % GRID), min.y, middle.z + along(i / GRID));
        receivers.push(position, Vec3::Y, Vec3::ONE, 0);
    }
    Some(receivers)
}

fn errors<const N: usize>(
    mesh: &Arc<Mesh>,
    set: &SphereSet,
    light: Environment,
    receivers: &ReceiverBuffer,
    rules: [AdjustRule; N],
    progress: &dyn Progress,
) -> Option<[f64; N]> {
    let object = Object::new("mesh", mesh.clone()).spheres(set.clone());
    let scene = Scene::at_rest("one mesh", vec![object], light);
    let tracer = Tracer::new(&scene.frame(0));
    let shadow = |geometry, seed| {
        let options = Options { geometry, samples: SAMPLES, seed, ..Options::default() };
        estimate(&tracer, receivers.view(), &options, progress)
    };
    let mesh = shadow(Geometry::Mesh, 1);
    let weights = Arc::new(ReceiverWeights::equal(receivers.len()));
    let mut errors = [0.0; N];
    for (error, rule) in errors.iter_mut().zip(rules) {
        let spheres = shadow(Geometry::Spheres(rule), 2);
        let side = |estimate: &Estimate| Reference {
            standard_error: estimate.standard_error.clone(),
            draws: estimate.draws.clone(),
            ..Reference::exact(estimate.radiance.clone(), mesh.unshadowed_mean, weights.clone())
        };
        let reference = side(&mesh).with_noise_of_difference(&side(&spheres));
        *error = compare(&spheres.radiance, &reference)?.rel_rmse?;
    }
    Some(errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::{Sphere, builtin, progress::Silent};

    #[test]
    fn a_sphere_casts_its_own_shadow_and_a_larger_one_a_larger() {
        let mesh = Arc::new(builtin::shape("sphere").unwrap());
        let set = |radius| SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius }], ..SphereSet::default() };
        let error = |radius| ground_shadow_errors(&mesh, &set(radius), [AdjustRule::default()], &Silent).unwrap()[0];
        let exact = error(1.0);
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
        let smaller = error(0.8);
        assert!((smaller / expected - 1.0).abs() < 0.05, "{smaller} against {expected}");
        // A convex surface hides nothing from itself, nor do spheres below it, whatever their size.
        let own = |radius| own_surface_error(&mesh, &set(radius), &Silent).unwrap();
        assert!(own(1.0) < 4e-3 && own(0.8) < 4e-3);
        let disc = |radius| disc_shadow_error(&mesh, &set(radius), &Silent).unwrap();
        assert!(disc(1.0) < 8e-3 && disc(0.8) > 0.03, "{} {}", disc(1.0), disc(0.8));
    }

    /// A ball of radius 1 that dips 0.6 below the ground, as a mesh and as a sphere: who stands within the circle of
    /// radius 0.8 is in the dark, which the covering rule comes nearest to.
    #[test]
    fn under_a_ball_that_dips_below_the_ground_the_covering_rule_errs_least() {
        let mut mesh = builtin::shape("sphere").unwrap();
        mesh.positions.iter_mut().for_each(|p| p.y = p.y.max(-0.4));
        let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
        let rules = [AdjustRule::Covering, AdjustRule::Published, AdjustRule::Continuous];
        let [covering, published, continuous] = ground_shadow_errors(&Arc::new(mesh), &set, rules, &Silent).unwrap();
        assert!(covering < 0.9 * published && published < continuous, "{covering} {published} {continuous}");
    }
}
