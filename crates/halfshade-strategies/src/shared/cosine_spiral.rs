//! Directions about a normal for sums that stand for integrals with its cosine.

use glam::DVec3;
use halfshade_sh::quadrature::GOLDEN_ANGLE;

/// So many unit directions about +Z with the density cos/π: a spiral of equal steps.
pub(crate) fn cosine_spiral(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |k| {
        let squared = (k as f64 + 0.5) / count as f64;
        let (sin, cos) = (k as f64 * GOLDEN_ANGLE).sin_cos();
        let across = squared.sqrt();
        DVec3::new(across * cos, across * sin, (1.0 - squared).sqrt())
    })
}
