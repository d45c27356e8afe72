//! Glossy lobes times matrices of transfer, `b^T M l`.
//!
//! `b` is the lobe's power, fitted to the hemisphere in the vertex's own frame. `u = b^T M`, n⁴ products for each matrix, is a
//! transfer vector like those of diffuse surfaces: light is multiplied to it at the end, channel by channel.

use super::dot::{LightVectors, MOST_EIGHTS, Partial, add, eight_at};
use crate::shared::cosine_power::cosine_power;
use halfshade_sh::kernel::{LANES, MAX_BANDS, ShBatch};
use wide::f32x8;

/// Bands of a lobe before it is fitted.
pub(crate) const LOBE_BANDS: usize = MAX_BANDS;

/// Its coefficients.
const POWER: usize = LOBE_BANDS * LOBE_BANDS;

/// The vectors that stand for `max(axis·v, 0)^exponent` above the horizon of +z, for eight lobes; `fit` is that of
/// `halfshade_sh::hemisphere`.
pub(crate) fn fitted_power<const N: usize>(axis: [f32x8; 3], exponent: f32x8, fit: &[f32]) -> ShBatch<N> {
    let power: ShBatch<POWER> = cosine_power(axis, exponent);
    let mut vector = [f32x8::ZERO; N];
    let mut rest = fit;
    for l in 0..const { N.isqrt() } {
        for order in 0..=l {
            let (row, after) = rest.split_at(const { POWER.isqrt() } - order);
            rest = after;
            for (degree, &factor) in (order..).zip(row) {
                let [from, to] = [degree * (degree + 1), l * (l + 1)];
                let factor = f32x8::splat(factor);
                vector[to + order] = power[from + order].mul_add(factor, vector[to + order]);
                if order > 0 {
                    vector[to - order] = power[from - order].mul_add(factor, vector[to - order]);
                }
            }
        }
    }
    vector
}

/// Adds `b^T M l` of matrix `number` of a table with C matrices for each place, for lane `lane` of b.
#[inline(always)]
pub(crate) fn add_product<const N: usize, const C: usize>(
    table: &[f32],
    number: usize,
    lobe: &[[f32; LANES]; N],
    lane: usize,
    light: &LightVectors,
    sums: &mut Partial,
) {
    for vector in 0..C {
        let matrix = &table[(number * C + vector) * N * N..];
        let mut transfer = [f32x8::ZERO; MOST_EIGHTS];
        let transfer = &mut transfer[..const { N.div_ceil(LANES) }];
        for (i, b) in lobe.iter().enumerate() {
            let b = f32x8::splat(b[lane]);
            for (eight, sum) in transfer.iter_mut().enumerate() {
                *sum = eight_at(matrix, i * N + eight * LANES).mul_add(b, *sum);
            }
        }
        for (eight, values) in transfer.iter().enumerate() {
            add::<C>(*values, vector, eight, light, sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;
    use halfshade_sh::{
        basis, dispatch_bands,
        hemisphere::{Weight, fitted},
    };

    /// Powers in double precision: `I_l` by the recurrence over degrees.
    fn exact_power(axis: [f64; 3], exponent: f64) -> Vec<f64> {
        let mut integrals = vec![1.0 / (exponent + 1.0), 1.0 / (exponent + 2.0)];
        for l in 2..8 {
            let degree = l as f64;
            integrals.push(integrals[l - 2] * (exponent - degree + 2.0) / (exponent + degree + 1.0));
        }
        let y = basis::evaluate(8, axis);
        y.iter().enumerate().map(|(i, y)| std::f64::consts::TAU * integrals[i.isqrt()] * y).collect()
    }

    fn check<const N: usize, const C: usize>() {
        let bands = N.isqrt();
        let mut random = random(N as u64 + 7);
        let axis = [0.48_f32, -0.6, 0.64];
        let mut table: Vec<f32> = (0..3 * C * N * N).map(|_| random()).collect();
        table.extend([0.0; LANES - 1]);
        let coefficients: [Vec<f32>; 3] = std::array::from_fn(|_| (0..N).map(|_| random()).collect());
        let light: LightVectors = std::array::from_fn(|channel| {
            std::array::from_fn(|eight| {
                let at = |lane| coefficients[channel].get(eight * LANES + lane).copied().unwrap_or(0.0);
                f32x8::from(std::array::from_fn::<_, LANES, _>(at))
            })
        });
        for (weight, exponent) in [(Weight::Cosine, 5.0), (Weight::Equal, 0.0), (Weight::Cosine, 1e5)] {
            let fit = weight.fit(bands, 8);
            let single: Vec<f32> = fit.iter().map(|value| *value as f32).collect();
            let lobe: ShBatch<N> = fitted_power(axis.map(f32x8::splat), f32x8::splat(exponent as f32), &single);
            let exact = fitted(&fit, bands, 8, &exact_power(axis.map(f64::from), exponent));
            let size = exact.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let lanes = lobe.map(|value| value.to_array());
            for (found, exact) in lanes.iter().zip(&exact) {
                assert!(
                    (f64::from(found[3]) - exact).abs() < 3e-5 * size,
                    "{weight:?} {bands} {exponent}: {found:?} {exact}"
                );
            }
            let mut sums = [f32x8::ZERO; 3];
            add_product::<N, C>(&table, 1, &lanes, 5, &light, &mut sums);
            for channel in 0..3 {
                let matrix = &table[(C + channel.min(C - 1)) * N * N..][..N * N];
                let of_row = |row: &[f32]| -> f64 {
                    row.iter().zip(&coefficients[channel]).map(|(m, l)| f64::from(*m) * f64::from(*l)).sum()
                };
                let expected: f64 =
                    matrix.chunks_exact(N).zip(&lanes).map(|(row, b)| f64::from(b[5]) * of_row(row)).sum();
                let found = f64::from(sums[channel].reduce_add());
                assert!((found - expected).abs() < 1e-4 * size.max(1e-6) * N as f64, "{bands}: {found} {expected}");
            }
        }
    }

    #[test]
    fn products_are_those_of_plain_loops() {
        for bands in 1..=8 {
            let found = dispatch_bands!(bands, N => {
                check::<N, 1>();
                check::<N, 3>();
            });
            assert!(found.is_some());
        }
    }
}
