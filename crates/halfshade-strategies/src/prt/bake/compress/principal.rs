//! Principal components of some rows, in double precision.
//!
//! ```text
//! x ≈ m + Σ_k ((x - m)·b_k) b_k        m = mean of x        C b_k = λ_k b_k,  C = Σ (x - m)(x - m)ᵀ,  λ_0 ≥ λ_1 ≥ ..
//! ```
//!
//! The sum of squared errors is that of the eigenvalues that are left out, the least that a flat of so many dimensions allows.
//! Fewer rows than numbers make the smaller matrix of their products with each other, which has the same eigenvalues.

use super::table::Rows;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Eigenvalues below this part of the largest are rounding.
const ROUNDING: f64 = 1e-13;

/// Rows whose products are added at once.
const BLOCK: usize = 1024;

/// Rounds that eigenvalues may take: many times what they need.
const MOST_ROUNDS: usize = 10_000;

/// A flat through the middle of some rows.
#[derive(Debug)]
pub(crate) struct Flat {
    pub(crate) mean: DVector<f64>,
    /// Orthonormal, the largest eigenvalue first; as many as were asked for, or as the rows span.
    pub(crate) axes: Vec<DVector<f64>>,
}

impl Flat {
    /// The flat of at most so many dimensions that is nearest to the rows with these numbers.
    pub(crate) fn fit(rows: &Rows, members: &[u32], components: usize) -> Self {
        let width = rows.width();
        let mut mean = DVector::zeros(width);
        for &member in members {
            mean.iter_mut().zip(rows.row(member)).for_each(|(sum, &value)| *sum += f64::from(value));
        }
        mean /= members.len().max(1) as f64;
        let components = components.min(width).min(members.len().saturating_sub(1));
        let axes = match components {
            0 => Vec::new(),
            _ if members.len() < width => {
                let x = differences(rows, members, &mean);
                // b = X u / √λ, from the products of rows with each other.
                axes(x.tr_mul(&x), components).into_iter().map(|(value, axis)| &x * axis / value.sqrt()).collect()
            }
            _ => {
                let mut covariance = DMatrix::zeros(width, width);
                for block in members.chunks(BLOCK) {
                    let x = differences(rows, block, &mean);
                    covariance.gemm(1.0, &x, &x.transpose(), 1.0);
                }
                axes(covariance, components).into_iter().map(|(_, axis)| axis).collect()
            }
        };
        Self { mean, axes }
    }
}

/// Columns x - m.
fn differences(rows: &Rows, members: &[u32], mean: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(rows.width(), members.len(), |i, j| f64::from(rows.row(members[j])[i]) - mean[i])
}

/// The largest eigenvalues and their vectors, as far as they aren't rounding.
fn axes(matrix: DMatrix<f64>, count: usize) -> Vec<(f64, DVector<f64>)> {
    let Some(eigen) = SymmetricEigen::try_new(matrix, f64::EPSILON, MOST_ROUNDS) else { return Vec::new() };
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let least = ROUNDING * eigen.eigenvalues[order[0]];
    let kept = order.into_iter().take(count).filter(|&k| eigen.eigenvalues[k] > least.max(f64::MIN_POSITIVE));
    kept.map(|k| (eigen.eigenvalues[k], eigen.eigenvectors.column(k).into_owned())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    fn squared_error(rows: &Rows, flat: &Flat, count: usize) -> f64 {
        let error = |i: usize| {
            let mut rest = DVector::from_iterator(rows.width(), rows.row(i as u32).iter().map(|&x| f64::from(x)));
            rest -= &flat.mean;
            flat.axes.iter().for_each(|axis| rest -= axis * axis.dot(&rest));
            rest.norm_squared()
        };
        (0..count).map(error).sum()
    }

    /// Eigenvalues come from the singular values of the rows, another path than either matrix.
    #[test]
    fn errors_are_the_eigenvalues_left_out() {
        let mut random = random(5);
        for (count, width) in [(7, 12), (40, 12), (3, 1), (12, 12), (3000, 9)] {
            let values: Vec<f32> = (0..count * width).map(|i| random() * [1.0, 0.3, 0.1][i % 3]).collect();
            let rows = Rows::new(&values, width);
            let members: Vec<u32> = (0..count as u32).collect();
            let mean = Flat::fit(&rows, &members, 0).mean;
            let singular = differences(&rows, &members, &mean).singular_values();
            let mut squares: Vec<f64> = singular.iter().map(|value| value * value).collect();
            squares.sort_by(|a, b| b.total_cmp(a));
            for components in [0, 1, 2, 5, width] {
                let flat = Flat::fit(&rows, &members, components);
                let left_out: f64 = squares.iter().skip(components).sum();
                let error = squared_error(&rows, &flat, count);
                assert!(
                    (error - left_out).abs() < 1e-11 * squares[0],
                    "{count} {width} {components}: {error} {left_out}"
                );
            }
        }
    }

    #[test]
    fn rows_alike_span_nothing() {
        let rows = Rows::new(&[0.25, 0.5, 0.25, 0.5, 0.25, 0.5], 2);
        for members in [&[0, 1, 2][..], &[1], &[]] {
            let flat = Flat::fit(&rows, members, 5);
            assert!(flat.axes.is_empty() && flat.mean.iter().all(|x| x.is_finite()));
        }
    }
}
