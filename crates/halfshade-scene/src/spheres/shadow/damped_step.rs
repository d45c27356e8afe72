//! The step of Levenberg and Marquardt's method, found by conjugate gradients: thousands of residuals know few of up to
//! thousands of spheres each, so that the matrix is never written down.

use super::rows::{PerSphere, Rows, dot};

/// Conjugate gradients at most, and the part of the first residual's square at which they end.
const MOST: usize = 60;
const ENOUGH: f64 = 1e-4;
/// Least curvature of a number, as a fraction of the largest: of spheres that nothing knows the matrix is singular.
const LEAST: f64 = 1e-4;

/// About the least of |r + J x|² + damping |D x|², where D² is the diagonal of JᵀJ.
pub(super) fn damped_step(rows: &Rows, spheres: usize, damping: f64) -> Vec<PerSphere> {
    let mut diagonal = rows.squares(spheres);
    let largest = diagonal.iter().flatten().copied().fold(0.0, f64::max);
    let mut x = vec![[0.0; 4]; spheres];
    if largest <= 0.0 {
        return x;
    }
    diagonal.iter_mut().flatten().for_each(|square| *square += LEAST * largest);
    let mut rest = rows.descent(spheres);
    let mut scaled = divided(&rest, &diagonal);
    let mut search = scaled.clone();
    let mut square = product(&rest, &scaled);
    let enough = ENOUGH * square;
    for _ in 0..MOST {
        if square <= enough {
            break;
        }
        let mut image = rows.normal_product(&search);
        for ((image, diagonal), search) in image.iter_mut().zip(&diagonal).zip(&search) {
            (0..4).for_each(|n| image[n] += damping * diagonal[n] * search[n]);
        }
        let length = square / product(&search, &image);
        add(&mut x, length, &search);
        add(&mut rest, -length, &image);
        scaled = divided(&rest, &diagonal);
        let before = std::mem::replace(&mut square, product(&rest, &scaled));
        search.iter_mut().flatten().for_each(|x| *x *= square / before);
        add(&mut search, 1.0, &scaled);
    }
    x
}

fn divided(a: &[PerSphere], b: &[PerSphere]) -> Vec<PerSphere> {
    a.iter().zip(b).map(|(a, b)| std::array::from_fn(|n| a[n] / b[n])).collect()
}

fn product(a: &[PerSphere], b: &[PerSphere]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

fn add(sum: &mut [PerSphere], factor: f64, other: &[PerSphere]) {
    sum.iter_mut().flatten().zip(other.iter().flatten()).for_each(|(sum, x)| *sum += factor * x);
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Against a Cholesky factorization of the matrix written down.
    #[test]
    fn agrees_with_a_dense_solution() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let (spheres, count) = (3, 40);
        let (mut rows, mut dense, mut right) = (Rows::default(), DMatrix::zeros(count, 12), DVector::zeros(count));
        for row in 0..count {
            right[row] = rng.random_range(-1.0..1.0);
            let known: Vec<(usize, PerSphere)> = (row % 2..spheres)
                .map(|sphere| (sphere, std::array::from_fn(|_| rng.random_range(-1.0..1.0))))
                .collect();
            for (sphere, slope) in &known {
                (0..4).for_each(|n| dense[(row, 4 * sphere + n)] = slope[n]);
            }
            rows.push(1.0, right[row], known.into_iter());
        }
        for damping in [0.0, 0.3] {
            let mut matrix = dense.transpose() * &dense;
            let largest = matrix.diagonal().max();
            (0..12).for_each(|n| matrix[(n, n)] += damping * (matrix[(n, n)] + LEAST * largest));
            let expected = matrix.cholesky().unwrap().solve(&(-dense.transpose() * &right));
            let found = damped_step(&rows, spheres, damping);
            let error: f64 = found.iter().flatten().zip(expected.iter()).map(|(a, b)| (a - b).powi(2)).sum();
            assert!(error.sqrt() < 0.02 * expected.norm(), "{found:?} {expected}");
        }
        assert_eq!(damped_step(&Rows::default(), 2, 0.1), [[0.0; 4]; 2]);
    }
}
