//! Coefficients of an SH field at a place [Tamura2006, 5.1]: four stored samples, interpolated and decoded.

use halfshade_sh::kernel::{LANES, ShBatch};
use wide::f32x8;

/// Most coefficients of a sample: 8 bands.
pub(crate) const MOST: usize = 64;

/// Adds `share` of the weighted sum of four samples, decoded as `least + step · value`; weights are of sum 1.
///
/// Samples lie one after another in `values`, `stride` numbers each, a multiple of 8; `least` and `step` have as many.
#[inline(always)]
pub(crate) fn add_samples<T>(
    values: &[T],
    decode: impl Fn(&T) -> f32,
    [least, step]: [&[f32]; 2],
    samples: [(usize, f32); 4],
    share: f32,
    sum: &mut [f32; MOST],
) {
    let stride = least.len();
    let row = |(sample, _): (usize, f32)| values[sample * stride..][..stride].as_chunks::<8>().0;
    let (a, b, c, d) = (row(samples[0]), row(samples[1]), row(samples[2]), row(samples[3]));
    let weights = samples.map(|(_, weight)| f32x8::splat(weight));
    let table = least.as_chunks::<8>().0.iter().zip(step.as_chunks::<8>().0);
    let corners = a.iter().zip(b).zip(c.iter().zip(d));
    let load = |eight: &[T; 8]| f32x8::from(eight.each_ref().map(&decode));
    for ((sum, (least, step)), ((a, b), (c, d))) in sum.as_chunks_mut::<8>().0.iter_mut().zip(table).zip(corners) {
        let mixed = load(a).mul_add(weights[0], load(b) * weights[1]);
        let mixed = load(c).mul_add(weights[2], load(d).mul_add(weights[3], mixed));
        let found = mixed.mul_add(f32x8::from(*step), f32x8::from(*least));
        *sum = found.mul_add(f32x8::splat(share), f32x8::from(*sum)).to_array();
    }
}

/// Vectors of eight receivers, one after another, as a batch: coefficient by coefficient.
#[inline(always)]
pub(crate) fn transposed<const N: usize>(vectors: &[[f32; MOST]; LANES]) -> ShBatch<N> {
    let mut batch = [f32x8::ZERO; N];
    for (block, rows) in batch.chunks_mut(LANES).enumerate() {
        let eight = vectors.each_ref().map(|vector| f32x8::from(vector.as_chunks::<LANES>().0[block]));
        rows.copy_from_slice(&f32x8::transpose(eight)[..rows.len()]);
    }
    batch
}
