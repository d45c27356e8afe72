//! Vectors of three coordinates, eight side by side.

use wide::f32x8;

/// `a · b`, lane by lane.
#[inline(always)]
pub(crate) fn dot(a: &[f32x8; 3], b: &[f32x8; 3]) -> f32x8 {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
