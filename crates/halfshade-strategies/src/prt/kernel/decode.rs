//! Compressed transfer times light: `m_c · l + Σ_k a_k (b_ck · l)`, for eight receivers.
//!
//! Products with light come with all three channels, so that a weight is read once and multiplied with all of them.

use super::dot::{Between, LightVectors, added, of_row as products_of_row};
use halfshade_sh::kernel::LANES;
use wide::{f32x4, f32x8};

/// Light times a vector: red, green, blue, and 0.
pub(crate) type Product = [f32; 4];

/// A compressed table: weights by row, and the cluster that they are of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weights<'a> {
    /// Weights of a row.
    pub(crate) components: usize,
    pub(crate) of_row: &'a [u16],
    pub(crate) weights: &'a [f32],
}

/// Light times as many rows of C vectors of N numbers as there is room for, the same as for a table that isn't compressed.
/// `vectors` ends in as many zeros as that has.
pub(crate) fn multiply<const N: usize, const C: usize>(
    vectors: &[f32],
    light: &LightVectors,
    products: &mut [Product],
) {
    for (eight, products) in products.chunks_mut(LANES).enumerate() {
        let row = |lane: usize| &vectors[(eight * LANES + lane.min(products.len() - 1)) * C * N..];
        let sums = added(|lane| products_of_row::<N, C>(row(lane), light)).map(f32x8::to_array);
        for (lane, product) in products.iter_mut().enumerate() {
            *product = [sums[0][lane], sums[1][lane], sums[2][lane], 0.0];
        }
    }
}

/// Radiance of a white receiver at a row.
#[inline(always)]
pub(crate) fn of_row(table: Weights<'_>, row: usize, products: &[Product]) -> f32x4 {
    let Weights { components, of_row, weights } = table;
    let products = &products[usize::from(of_row[row]) * (components + 1)..][..components + 1];
    let weights = &weights[row * components..][..components];
    let terms = weights.iter().zip(&products[1..]);
    terms.fold(f32x4::from(products[0]), |sum, (&weight, &product)| {
        f32x4::from(product).mul_add(f32x4::splat(weight), sum)
    })
}

/// The same between rows.
#[inline(always)]
pub(crate) fn between_rows(table: Weights<'_>, rows: &Between, products: &[Product]) -> f32x4 {
    let add =
        |sum: f32x4, &(row, weight): &(usize, f32)| of_row(table, row, products).mul_add(f32x4::splat(weight), sum);
    rows.iter().fold(f32x4::ZERO, add)
}

/// Channels of eight receivers.
#[inline(always)]
pub(crate) fn transposed(white: impl Fn(usize) -> f32x4) -> [f32x8; 3] {
    let [low, high] = [0, 4].map(|first| f32x4::transpose(std::array::from_fn(|lane| white(first + lane))));
    std::array::from_fn(|channel| f32x8::from([low[channel], high[channel]].map(f32x4::to_array).as_flattened()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    #[test]
    fn sums_are_those_of_plain_loops() {
        let mut random = random(7);
        for components in [0, 1, 5, 8] {
            let products: Vec<Product> =
                (0..4 * (components + 1)).map(|_| [random(), random(), random(), 0.0]).collect();
            let of_row: Vec<u16> = (0..20).map(|row| row * row % 4).collect();
            let weights: Vec<f32> = (0..20 * components).map(|_| random()).collect();
            let table = Weights { components, of_row: &of_row, weights: &weights };
            let exact = |row: usize, channel: usize| -> f64 {
                let product = |k: usize| f64::from(products[usize::from(of_row[row]) * (components + 1) + k][channel]);
                let terms = (0..components).map(|k| f64::from(weights[row * components + k]) * product(k + 1));
                product(0) + terms.sum::<f64>()
            };
            let whole = transposed(|lane| super::of_row(table, lane + 3, &products));
            let mixed = transposed(|lane| between_rows(table, &[(lane, 0.2), (19, 0.5), (lane + 1, 0.3)], &products));
            for (lane, channel) in (0..LANES).flat_map(|lane| (0..3).map(move |channel| (lane, channel))) {
                let found = |of: &[f32x8; 3]| f64::from(of[channel].to_array()[lane]);
                assert!((found(&whole) - exact(lane + 3, channel)).abs() < 2e-6);
                let at = |row| exact(row, channel);
                let expected = 0.2 * at(lane) + 0.5 * at(19) + 0.3 * at(lane + 1);
                assert!((found(&mixed) - expected).abs() < 2e-6);
            }
        }
    }

    #[test]
    fn vectors_are_multiplied_one_by_one() {
        let mut random = random(9);
        const N: usize = 9;
        for count in [0, 1, 8, 19] {
            let mut vectors: Vec<f32> = (0..count * 3 * N).map(|_| random()).collect();
            vectors.extend([0.0; LANES - 1]);
            let coefficients: [[f32; 16]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|i| if i < N { random() } else { 0.0 }));
            let mut light = LightVectors::default();
            for (light, numbers) in light.iter_mut().zip(&coefficients) {
                (0..2).for_each(|eight| light[eight] = f32x8::from(&numbers[8 * eight..][..8]));
            }
            let mut products = vec![Product::default(); count];
            multiply::<N, 3>(&vectors, &light, &mut products);
            for (row, product) in products.iter().enumerate() {
                for channel in 0..3 {
                    let vector = &vectors[(3 * row + channel) * N..][..N];
                    let exact: f64 =
                        vector.iter().zip(&coefficients[channel]).map(|(t, l)| f64::from(*t) * f64::from(*l)).sum();
                    assert!((f64::from(product[channel]) - exact).abs() < 2e-6);
                }
                assert_eq!(product[3], 0.0);
            }
        }
    }
}
