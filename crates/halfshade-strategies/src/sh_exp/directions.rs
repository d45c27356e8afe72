//! Even directions over the sphere, ready for projections.

use glam::DVec3;
use halfshade_sh::{basis, quadrature::golden_spiral};
use std::f64::consts::PI;

/// `count` unit directions, each with the basis there times its solid angle 4π/count.
///
/// They lie on the golden spiral about a level axis, so that no whole turn of it runs along a level horizon.
pub(super) fn weighted_directions(bands: usize, count: usize) -> impl Iterator<Item = (DVec3, Vec<f32>)> {
    let solid_angle = 4.0 * PI / count as f64;
    golden_spiral(count).map(move |[y, x, z]| {
        let direction = [x, y, z];
        let values = basis::evaluate(bands, direction);
        (direction.into(), values.into_iter().map(|value| (solid_angle * value) as f32).collect())
    })
}
