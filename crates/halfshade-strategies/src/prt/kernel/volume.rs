//! Radiance of a white receiver in a volume of incoming light, `Σ_i t_i Σ_p w_p L_pi`.
//!
//! t is the clamped cosine about the normal over π, L the light that arrives at the points around.

use super::{decode::Product, grid::Around};
use wide::f32x4;

/// Bands of incoming light: a cosine has nearly nothing beyond.
pub(crate) const BANDS: usize = 3;

/// Numbers of a point and channel.
pub(crate) const COEFFICIENTS: usize = BANDS * BANDS;

/// `incoming` holds the coefficients of point after point.
#[inline(always)]
pub(crate) fn reflected(incoming: &[Product], around: &Around, transfer: &[f32; COEFFICIENTS]) -> f32x4 {
    let mut radiance = f32x4::ZERO;
    for &(point, weight) in around {
        let light = incoming[point * COEFFICIENTS..][..COEFFICIENTS].iter().zip(transfer);
        let at_point = light.fold(f32x4::ZERO, |sum, (&light, &t)| f32x4::from(light).mul_add(f32x4::splat(t), sum));
        radiance = at_point.mul_add(f32x4::splat(weight), radiance);
    }
    radiance
}
