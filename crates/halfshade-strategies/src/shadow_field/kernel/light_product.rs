//! Light times transfer in spherical harmonics: `S · U` of distant light, and of a local light, which is a cap.

use halfshade_sh::{
    blocker_table::BlockerTable,
    kernel::{self, FULL, ShBatch},
};
use wide::f32x8;

/// S_j of a light of radiance 1: its cap, or all directions where it `is_around` the receiver. Its centre is at `offset`.
pub(crate) fn light_cap<const N: usize>(
    offset: &[f32x8; 3],
    distance_squared: f32x8,
    is_around: f32x8,
    radius: f32,
    table: &BlockerTable,
) -> ShBatch<N> {
    let squared = distance_squared.fast_max(f32x8::splat(f32::MIN_POSITIVE));
    let inverse = f32x8::ONE / squared.sqrt();
    let direction = offset.map(|axis| axis * inverse);
    let sine_squared = (f32x8::splat(radius * radius) / squared).fast_min(f32x8::ONE);
    let scale = table.lookup::<N>(sine_squared);
    let mut minus_cap = [f32x8::ZERO; N];
    kernel::accumulate_lobe(direction, &scale, &mut minus_cap);
    std::array::from_fn(|i| {
        let all = if i == 0 { f32x8::splat(FULL) } else { f32x8::ZERO };
        is_around.select(all, -minus_cap[i])
    })
}

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
