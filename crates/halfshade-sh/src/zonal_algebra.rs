//! The product algebra of zonal functions: products of functions about one axis stay about it, so that logarithm and
//! exponential need eigenvalues of a matrix of `bands` rows instead of `bands²`.

use crate::logarithm::log_ratio;
use crate::{basis, tripling, zonal};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::borrow::Cow;
use std::sync::OnceLock;

/// `∫ y_a^0 y_b^0 y_c^0` as (a, b, c, value), every order of the three listed.
fn zonal_tensor(bands: usize) -> Cow<'static, [(usize, usize, usize, f64)]> {
    type Entries = Vec<(usize, usize, usize, f64)>;
    static TENSORS: [OnceLock<Entries>; 17] = [const { OnceLock::new() }; 17];
    let compute = || {
        let index = |l: usize| basis::index(l, 0);
        let all = |a: usize| (0..bands).flat_map(move |b| (0..bands).map(move |c| (a, b, c)));
        let entry = |(a, b, c)| (a, b, c, tripling::coefficient(index(a), index(b), index(c)));
        (0..bands).flat_map(all).map(entry).filter(|entry| entry.3 != 0.0).collect::<Entries>()
    };
    match TENSORS.get(bands) {
        Some(slot) => slot.get_or_init(compute).as_slice().into(),
        None => compute().into(),
    }
}

/// The (l, 0) rows and columns of the product matrix of a zonal function; the eigenvectors of the whole matrix that a
/// zonal vector meets live here alone.
fn zonal_product_matrix(g: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(g.len(), g.len());
    for &(a, b, c, value) in zonal_tensor(g.len()).iter() {
        matrix[(a, b)] += value * g[c];
    }
    matrix
}

fn through_eigenvalues(matrix: DMatrix<f64>, vector: DVector<f64>, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let eigen = SymmetricEigen::new(matrix);
    let mut rotated = eigen.eigenvectors.tr_mul(&vector);
    rotated.iter_mut().zip(eigen.eigenvalues.iter()).for_each(|(value, &x)| *value *= f(x));
    (eigen.eigenvectors * rotated).as_slice().to_vec()
}

fn one(bands: usize) -> DVector<f64> {
    let mut one = DVector::zeros(bands);
    one[0] = zonal::rotation_scale(0);
    one
}

/// [`crate::logarithm::logarithm`] of a zonal function, zonal in and out, with the same `clip`.
pub fn logarithm(g: &[f64], clip: f64) -> Vec<f64> {
    let difference = DVector::from_column_slice(g) - one(g.len());
    through_eigenvalues(zonal_product_matrix(g), difference, |x| log_ratio(x.max(clip)))
}

/// Logarithm of the blocker `1 - cap`, from the cap: as [`logarithm`], but accurate relative to a tiny cap as well.
pub fn logarithm_of_blocker(cap: &[f64], clip: f64) -> Vec<f64> {
    let difference = -DVector::from_column_slice(cap);
    through_eigenvalues(zonal_product_matrix(cap), difference, |x| {
        let clipped = (-x).max(clip - 1.0);
        if clipped == 0.0 { 1.0 } else { clipped.ln_1p() / clipped }
    })
}

/// [`crate::exponential::full_series`] of a zonal function, zonal in and out.
pub fn exponential(f: &[f64]) -> Vec<f64> {
    through_eigenvalues(zonal_product_matrix(f), one(f.len()), f64::exp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logarithm::DEFAULT_CLIP;
    use crate::{exponential, logarithm};

    #[test]
    fn agrees_with_the_general_algebra() {
        for bands in 1..=6 {
            for radius in [0.01, 0.3, 0.95, 1.5] {
                let blocker = zonal::blocker(bands, f64::cos(radius));
                let log = super::logarithm(&blocker, DEFAULT_CLIP);
                let from_cap = logarithm_of_blocker(&zonal::cap(bands, f64::cos(radius)), DEFAULT_CLIP);
                for (a, b) in log.iter().zip(from_cap) {
                    assert!((a - b).abs() < 1e-11);
                }
                let general = logarithm::logarithm(&zonal::to_spherical(&blocker), DEFAULT_CLIP);
                for (a, b) in zonal::to_spherical(&log).iter().zip(&general) {
                    assert!((a - b).abs() < 1e-10, "{bands} {radius}: {a} {b}");
                }
                let exponential = super::exponential(&log);
                for (a, b) in zonal::to_spherical(&exponential).iter().zip(exponential::full_series(&general)) {
                    assert!((a - b).abs() < 1e-10);
                }
            }
        }
    }
}
