//! SH rotation from object space into light space, and visibility from occlusion.

use halfshade_sh::{
    kernel::{FULL, ShBatch},
    rotation::ShRotation,
};
use wide::f32x8;

/// The blocks of a rotation as [`rotated`] reads them.
pub(crate) fn blocks(rotation: &ShRotation) -> Vec<f32> {
    let rows = |l: usize| rotation.block(l).transpose().iter().map(|&value| value as f32).collect::<Vec<_>>();
    (0..rotation.bands()).flat_map(rows).collect()
}

/// Eight vectors, turned band by band. `blocks` holds the block of each band row by row, one after another.
#[inline(always)]
pub(crate) fn rotated<const N: usize>(vector: &ShBatch<N>, blocks: &[f32]) -> ShBatch<N> {
    let mut rotated = [f32x8::ZERO; N];
    let mut blocks = blocks;
    for l in 0..const { N.isqrt() } {
        let side = 2 * l + 1;
        let (block, rest) = blocks.split_at(side * side);
        blocks = rest;
        for (row, sum) in block.chunks_exact(side).zip(&mut rotated[l * l..]) {
            for (&weight, value) in row.iter().zip(&vector[l * l..]) {
                *sum = value.mul_add(f32x8::splat(weight), *sum);
            }
        }
    }
    rotated
}

/// `1 - B`: the visibility that an occlusion B leaves.
#[inline(always)]
pub(crate) fn visible<const N: usize>(blocked: &ShBatch<N>) -> ShBatch<N> {
    let mut visible = blocked.map(|value| -value);
    visible[0] += f32x8::splat(FULL);
    visible
}
