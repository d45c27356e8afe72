//! The product algebra of zonal functions: products of functions about one axis stay about it, so that logarithm and
//! exponential need eigenvalues of a matrix of `bands` rows instead of `bands²`.

use crate::product::tensor;
use crate::zonal;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The (l, 0) rows and columns of the product matrix of a zonal function; eigenvectors of the whole matrix with
/// m = 0 live here alone.
fn zonal_product_matrix(g: &[f64]) -> DMatrix<f64> {
    let bands = g.len();
    let band_of = |i: usize| (0..bands).find(|l| l * (l + 1) == i);
    let mut matrix = DMatrix::zeros(bands, bands);
    for triple in tensor(bands).iter() {
        let zonal = [triple.i, triple.j, triple.k].into_iter().all(|i| band_of(i).is_some());
        if !zonal {
            continue;
        }
        for [i, j, k] in triple.permutations() {
            if let (Some(row), Some(column), Some(l)) = (band_of(i), band_of(j), band_of(k)) {
                matrix[(row, column)] += triple.value * g[l];
            }
        }
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
    through_eigenvalues(zonal_product_matrix(g), difference, |x| crate::logarithm::log_ratio(x.max(clip)))
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
