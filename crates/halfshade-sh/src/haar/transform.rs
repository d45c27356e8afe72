//! Wavelet transform of a face's texels, and its inverse.

use wide::f32x8;

/// Texels to coefficients, in place; `face` has `4^L` values.
///
/// On each level, from the finest: the mean of four quarters and, over `2^l`, their differences [Guerrero2007, 3.4].
pub fn forward(face: &mut [f32]) {
    let mut squares = face.len() / 4;
    while squares > 0 {
        let mean = f32x8::splat(0.25);
        let weight = f32x8::splat(0.25 / (squares as f32).sqrt());
        butterfly(&mut face[..4 * squares], |[a, b, c, d]| {
            let (top, bottom) = (a + b, c + d);
            let (left, right) = (a - b, c - d);
            [(top + bottom) * mean, (left + right) * weight, (top - bottom) * weight, (left - right) * weight]
        });
        squares /= 4;
    }
}

/// Coefficients to texels, in place; `face` has `4^L` values. The inverse of [`forward`].
pub fn inverse(face: &mut [f32]) {
    let mut squares = 1;
    while 4 * squares <= face.len() {
        let weight = f32x8::splat((squares as f32).sqrt());
        butterfly(&mut face[..4 * squares], |[mean, across, down, both]| {
            let [across, down, both] = [across * weight, down * weight, both * weight];
            let (top, bottom) = (mean + down, mean - down);
            let (left, right) = (across + both, across - both);
            [top + left, top - left, bottom + right, bottom - right]
        });
        squares *= 4;
    }
}

/// Four values of every square, each a quarter of `level` from the next, through `step`.
#[inline(always)]
fn butterfly(level: &mut [f32], step: impl Fn([f32x8; 4]) -> [f32x8; 4]) {
    let quarter = level.len() / 4;
    let (ab, cd) = level.split_at_mut(2 * quarter);
    let ((a, b), (c, d)) = (ab.split_at_mut(quarter), cd.split_at_mut(quarter));
    let [a, b, c, d] = [a, b, c, d].map(|row| row.chunks_mut(8));
    for (((a, b), c), d) in a.zip(b).zip(c).zip(d) {
        // The coarsest levels don't fill a register.
        let load = |row: &[f32]| match <[f32; 8]>::try_from(row) {
            Ok(lanes) => f32x8::from(lanes),
            Err(_) => f32x8::from(std::array::from_fn::<f32, 8, _>(|k| row.get(k).copied().unwrap_or(0.0))),
        };
        let results = step([load(a), load(b), load(c), load(d)]);
        for (row, result) in [a, b, c, d].into_iter().zip(results) {
            row.copy_from_slice(&result.as_array()[..row.len()]);
        }
    }
}
