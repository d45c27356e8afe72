//! SH vectors baked per vertex, at receivers that lie between vertices.

use halfshade_scene::{Mesh, SurfacePoint};
use halfshade_sh::kernel::{LANES, MAX_BANDS, ShBatch};
use wide::f32x8;

/// Vectors of N coefficients per vertex of `mesh`, interpolated at the eight points that `surface` gives; and the mask of the
/// lanes in which they are known. They aren't off the mesh, nor where a normal points to the other side than the vertices'.
#[inline(always)]
pub(crate) fn interpolated<const N: usize>(
    mesh: &Mesh,
    vectors: &[f32],
    surface: impl Fn(usize) -> SurfacePoint,
) -> (ShBatch<N>, f32x8) {
    let mut vector = [f32x8::ZERO; N];
    let mut known = [0.0_f32; LANES];
    let (mut rows, mut rest) = ([[f32x8::ZERO; LANES]; MOST_ROWS], [[0.0_f32; LANES]; LANES]);
    let whole = const { N / LANES };
    for lane in 0..LANES {
        let Some(between) = surface(lane).weights_in_front(mesh) else { continue };
        for (vertex, weight) in between.parts() {
            let (eights, others) = vectors[vertex * N..(vertex + 1) * N].as_chunks::<LANES>();
            for (rows, &eight) in rows.iter_mut().zip(eights) {
                rows[lane] = f32x8::from(eight).mul_add(f32x8::splat(weight), rows[lane]);
            }
            rest.iter_mut().zip(others).for_each(|(row, &value)| row[lane] = weight.mul_add(value, row[lane]));
        }
        known[lane] = 1.0;
    }
    for (eight, rows) in vector.chunks_exact_mut(LANES).zip(rows) {
        eight.copy_from_slice(&f32x8::transpose(rows));
    }
    vector[whole * LANES..].iter_mut().zip(rest).for_each(|(value, lanes)| *value = f32x8::from(lanes));
    (vector, f32x8::from(known).simd_gt(f32x8::ZERO))
}

/// Rows of eight of the largest vector.
const MOST_ROWS: usize = MAX_BANDS * MAX_BANDS / LANES;
