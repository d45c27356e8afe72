//! Even directions over the sphere, ready for projections.

use glam::DVec3;
use halfshade_sh::basis;
use std::f64::consts::PI;

/// `count` unit directions, each with the basis there times its solid angle 4π/count.
///
/// They lie on the golden spiral about a level axis, so that no whole turn of it runs along a level horizon.
pub(super) fn weighted_directions(bands: usize, count: usize) -> impl Iterator<Item = (DVec3, Vec<f32>)> {
    let (golden, solid_angle) = (PI * (3.0 - 5.0_f64.sqrt()), 4.0 * PI / count as f64);
    (0..count).map(move |i| {
        let x = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let ring = (1.0 - x * x).max(0.0).sqrt();
        let direction = DVec3::new(x, ring * cos, ring * sin);
        let values = basis::evaluate(bands, direction.to_array());
        (direction, values.into_iter().map(|value| (solid_angle * value) as f32).collect())
    })
}
