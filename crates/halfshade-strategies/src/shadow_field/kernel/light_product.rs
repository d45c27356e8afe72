//! Light times transfer in spherical harmonics: `S · U` of distant light, and of a local light, which is a cap
//! (`shared/light_cap.rs`).

use halfshade_sh::kernel::{self, ShBatch};
use wide::f32x8;

/// Adds `S · U` of a local light: its cap times `transfer`, by colour.
#[inline(always)]
pub(crate) fn add_local<const N: usize>(
    cap: &ShBatch<N>,
    transfer: &ShBatch<N>,
    color: [f32; 3],
    radiance: &mut [f32x8; 3],
) {
    let reached = kernel::dot(cap, transfer);
    (0..3).for_each(|c| radiance[c] += reached * f32x8::splat(color[c]));
}

/// Adds `S_d · U` of distant light, coefficient by coefficient in red, green and blue.
#[inline(always)]
pub(crate) fn add_distant<const N: usize>(light: &[[f32; 3]], transfer: &ShBatch<N>, radiance: &mut [f32x8; 3]) {
    for (values, weights) in transfer.iter().zip(light) {
        (0..3).for_each(|c| radiance[c] = values.mul_add(f32x8::splat(weights[c]), radiance[c]));
    }
}
