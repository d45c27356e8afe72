//! Products over the texels of a cube map: of visibility, by texel or as wavelets, and of light.

use glam::Vec3;
use halfshade_sh::haar::{product::product, transform};
use std::f32::consts::FRAC_1_PI;

/// Texels of all faces to coefficients of wavelets, in place.
pub(crate) fn forward(face_len: usize, dense: &mut [f32]) {
    dense.chunks_exact_mut(face_len).for_each(transform::forward);
}

/// Coefficients of all faces to texels, in place.
pub(crate) fn inverse(face_len: usize, dense: &mut [f32]) {
    dense.chunks_exact_mut(face_len).for_each(transform::inverse);
}

/// Calls with number and value of each of the `count` texels from `first`: the mean of four texels of another cube map, or
/// the same texel of it without `sources`.
#[inline(always)]
pub(crate) fn each_remapped(
    [first, count]: [usize; 2],
    values: &[f32],
    sources: Option<&[[u16; 4]]>,
    mut use_value: impl FnMut(usize, f32),
) {
    match sources {
        None => {
            for (k, value) in values[first..first + count].iter().enumerate() {
                use_value(k, *value);
            }
        }
        Some(sources) => {
            for (k, four) in sources[first..first + count].iter().enumerate() {
                let [a, b, c, d] = four.map(|source| values[usize::from(source)]);
                use_value(k, 0.25 * ((a + b) + (c + d)));
            }
        }
    }
}

/// `U = (1 - B) U` on the texels of a face from `first`, B remapped from `blocked`.
///
/// Occlusion lies within [0, 1], though the wavelets that are left may say otherwise.
pub(crate) fn hide_texels(transfer: &mut [f32], first: usize, blocked: &[f32], sources: Option<&[[u16; 4]]>) {
    each_remapped([first, transfer.len()], blocked, sources, |k, value| transfer[k] *= 1.0 - value.clamp(0.0, 1.0));
}

/// The same where U are wavelets, as a triple product. `visible` and `result` are a face's working memory.
pub(crate) fn hide_wavelets(
    transfer: &mut [f32],
    first: usize,
    blocked: &[f32],
    sources: Option<&[[u16; 4]]>,
    [visible, result]: [&mut [f32]; 2],
) {
    let set = |k: usize, value: f32| visible[k] = 1.0 - value.clamp(0.0, 1.0);
    each_remapped([first, transfer.len()], blocked, sources, set);
    transform::forward(visible);
    product(transfer, visible, result);
    transfer.copy_from_slice(result);
}

/// `max(n·ω, 0)/π` by texel.
pub(crate) fn clamped_cosine([x, y, z]: [&[f32]; 3], normal: Vec3, result: &mut [f32]) {
    for (((result, x), y), z) in result.iter_mut().zip(x).zip(y).zip(z) {
        *result = FRAC_1_PI * (x * normal.x + y * normal.y + z * normal.z).max(0.0);
    }
}

/// `Σ a b c`.
pub(crate) fn dot_three(a: &[f32], b: &[f32], c: &[f32]) -> f32 {
    a.iter().zip(b).zip(c).map(|((a, b), c)| a * b * c).sum()
}

/// The dot product, eight sums side by side.
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0_f32; 8];
    let (a_rows, b_rows) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = a_rows.remainder().iter().zip(b_rows.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_rows.zip(b_rows) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum = a.mul_add(*b, *sum);
        }
    }
    sums.iter().sum::<f32>() + rest
}
