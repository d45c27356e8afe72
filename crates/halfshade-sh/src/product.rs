//! The SH product and its matrix, in f64 for any number of bands: the reference for the f32 kernels.

use crate::basis;
use crate::tripling::{self, Triple};
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// Number of bands that keep their tensor once it has been computed.
const CACHED_BANDS: usize = 12;

/// The non-zero tripling coefficients of `bands` bands with `i <= j <= k`; computed once per number of bands.
pub fn tensor(bands: usize) -> std::borrow::Cow<'static, [Triple]> {
    static TENSORS: [OnceLock<Vec<Triple>>; CACHED_BANDS + 1] = [const { OnceLock::new() }; CACHED_BANDS + 1];
    match TENSORS.get(bands) {
        Some(slot) => slot.get_or_init(|| tripling::distinct(bands)).as_slice().into(),
        None => tripling::distinct(bands).into(),
    }
}

fn bands_of_pair(f: &[f64], g: &[f64]) -> usize {
    assert_eq!(f.len(), g.len(), "both factors of a product have the same bands");
    basis::bands_of(f.len()).expect("an SH vector has bands² coefficients")
}

/// The SH product `(f*g)_i = Σ_jk Γ_ijk f_j g_k`: the product of the two functions, projected back onto their bands
/// [Guerrero2007, eq. 3.18-3.19].
///
/// # Panics
/// If the lengths differ or are no square.
pub fn product(f: &[f64], g: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; f.len()];
    for triple in tensor(bands_of_pair(f, g)).iter() {
        for [i, j, k] in triple.permutations() {
            result[i] += triple.value * f[j] * g[k];
        }
    }
    result
}

/// `f*f`.
pub fn square(f: &[f64]) -> Vec<f64> {
    product(f, f)
}

/// The symmetric matrix `(M_f)_ij = Σ_k Γ_ijk f_k`, so that `f*g = M_f g` [Guerrero2007, eq. 3.21-3.22].
///
/// # Panics
/// If the length of `f` is no square.
pub fn product_matrix(f: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(f.len(), f.len());
    for triple in tensor(bands_of_pair(f, f)).iter() {
        for [i, j, k] in triple.permutations() {
            matrix[(i, j)] += triple.value * f[k];
        }
    }
    matrix
}

/// The product matrix of `f` from `in_bands` to `out_bands` bands, row-major, `out_bands²` rows: coefficient
/// `Σ_k Γ_ijk f_k` for every k that `f` has.
///
/// `f` may have more bands than input and output: all its bands up to `in_bands + out_bands - 1` matter, which is how
/// a light with more bands than the visibility loses nothing in the product.
///
/// # Panics
/// If the length of `f` is no square.
pub fn rectangular_product_matrix(f: &[f64], in_bands: usize, out_bands: usize) -> DMatrix<f64> {
    let bands = basis::bands_of(f.len()).expect("an SH vector has bands² coefficients");
    let reach = bands.min((in_bands + out_bands).saturating_sub(1));
    DMatrix::from_fn(basis::coefficient_count(out_bands), basis::coefficient_count(in_bands), |i, j| {
        (0..basis::coefficient_count(reach)).map(|k| tripling::coefficient(i, j, k) * f[k]).sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::SphereQuadrature;
    use proptest::prelude::*;

    fn vector(bands: usize) -> impl Strategy<Value = Vec<f64>> {
        proptest::collection::vec(-1.0..1.0, basis::coefficient_count(bands))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(6))]

        #[test]
        fn product_agrees_with_quadrature((f, g) in (1usize..=8).prop_flat_map(|n| (vector(n), vector(n)))) {
            let bands = basis::bands_of(f.len()).unwrap();
            let rule = SphereQuadrature::exact_to(3 * (bands - 1));
            let projected = rule.project(bands, |s| basis::reconstruct(&f, s) * basis::reconstruct(&g, s));
            let matrix = product_matrix(&f) * nalgebra::DVector::from_column_slice(&g);
            for (i, value) in product(&f, &g).iter().enumerate() {
                prop_assert!((value - projected[i]).abs() < 1e-12, "{} {}", value, projected[i]);
                prop_assert!((value - matrix[i]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn a_light_with_more_bands_loses_nothing() {
        let light: Vec<f64> = (0..49).map(|i| f64::sin(1.0 + (3 * i) as f64)).collect();
        let visibility: Vec<f64> = (0..9).map(|i| f64::cos((5 * i) as f64)).collect();
        let matrix = rectangular_product_matrix(&light, 3, 4);
        let product = matrix * nalgebra::DVector::from_column_slice(&visibility);
        let rule = SphereQuadrature::exact_to(6 + 2 + 3);
        let projected = rule.project(4, |s| basis::reconstruct(&light, s) * basis::reconstruct(&visibility, s));
        for (value, expected) in product.iter().zip(projected) {
            assert!((value - expected).abs() < 1e-12);
        }
    }
}
