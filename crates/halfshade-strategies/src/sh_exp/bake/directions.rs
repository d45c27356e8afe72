//! Even directions over the sphere, ready for projections.

use glam::DVec3;
use halfshade_sh::{basis, quadrature::golden_spiral};
use std::f64::consts::PI;

/// `count` unit directions.
///
/// They lie on the golden spiral about a level axis, so that no whole turn of it runs along a level horizon.
pub(crate) fn even_directions(count: usize) -> impl ExactSizeIterator<Item = DVec3> {
    golden_spiral(count).map(|[y, x, z]| DVec3::new(x, y, z))
}

/// Each with the basis there times its solid angle, 4π over their count.
pub(crate) fn weighted(
    bands: usize,
    directions: impl ExactSizeIterator<Item = DVec3>,
) -> impl Iterator<Item = (DVec3, Vec<f32>)> {
    let solid_angle = 4.0 * PI / directions.len() as f64;
    directions.map(move |direction| {
        let values = basis::evaluate(bands, direction.to_array());
        (direction, values.into_iter().map(|value| (solid_angle * value) as f32).collect())
    })
}
