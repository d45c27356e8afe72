//! The SH logarithm by eigenanalysis of the product matrix.

use crate::basis;
use crate::product::product_matrix;
use nalgebra::{DVector, SymmetricEigen};

/// Eigenvalues below this are clipped to it before their logarithm is taken: the value that METHODS' figures use.
///
/// Smaller makes the logarithm of large blockers larger (the log of the clip) and the exponential harder; larger
/// leaks light through them.
pub const DEFAULT_CLIP: f64 = 1e-3;

/// Logarithm of the SH function `g` in the truncated product algebra: with `M_g = R^T D R`,
/// `log g = R^T q'(D) R (g - 1)`, `q'(x) = ln x/(x - 1)` [Guerrero2007, eq. 3.34].
///
/// Eigenvalues below `clip` (positive) are clipped to it. Not an exact inverse of the exponential, because
/// `M_{f*f} != M_f²` under truncation: at 4 bands exp(log(blocker)) errs by 3e-8 at 0.2 rad and by 1e-3 at 0.8 rad.
///
/// # Panics
/// If the length of `g` is no square.
pub fn logarithm(g: &[f64], clip: f64) -> Vec<f64> {
    let bands = basis::bands_of(g.len()).expect("an SH vector has bands² coefficients");
    let eigen = SymmetricEigen::new(product_matrix(g));
    let difference = DVector::from_column_slice(g) - DVector::from_vec(basis::one(bands));
    let mut rotated = eigen.eigenvectors.tr_mul(&difference);
    for (value, eigenvalue) in rotated.iter_mut().zip(eigen.eigenvalues.iter()) {
        *value *= log_ratio(eigenvalue.max(clip));
    }
    (eigen.eigenvectors * rotated).as_slice().to_vec()
}

/// `ln x/(x - 1)`, continuous at 1.
pub(crate) fn log_ratio(x: f64) -> f64 {
    let h = x - 1.0;
    if h == 0.0 { 1.0 } else { h.ln_1p() / h }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zonal;

    /// Magnitude without the constant coefficient.
    fn isolated_log_magnitude(radius: f64, clip: f64) -> f64 {
        let blocker = zonal::to_spherical(&zonal::blocker(4, radius.cos()));
        basis::magnitude(&logarithm(&blocker, clip)[1..])
    }

    #[test]
    fn negative_eigenvalue_appears_at_088() {
        let smallest = |radius: f64| {
            let blocker = zonal::to_spherical(&zonal::blocker(4, radius.cos()));
            product_matrix(&blocker).symmetric_eigenvalues().min()
        };
        assert!(smallest(0.87) > 0.0, "{}", smallest(0.87));
        assert!(smallest(0.90) < 0.0, "{}", smallest(0.90));
    }

    #[test]
    fn magnitude_jumps_where_the_clipping_starts() {
        // 5.9 belongs to a clip of 1e-2; at 1e-3 the jump is to 8.8, nearly the ratio of the clips' logarithms.
        for (radius, clip, expected) in [(0.81, 1e-2, 3.5), (0.91, 1e-2, 5.9), (0.81, 1e-3, 3.5), (0.91, 1e-3, 8.8)] {
            let magnitude = isolated_log_magnitude(radius, clip);
            assert!((magnitude - expected).abs() < 0.05, "{radius} {clip}: {magnitude}");
        }
    }

    #[test]
    fn logarithm_of_a_constant_is_exact() {
        let mut constant = basis::one(3);
        constant[0] *= 0.25;
        let log = logarithm(&constant, DEFAULT_CLIP);
        assert!((log[0] - 0.25f64.ln() * basis::one(3)[0]).abs() < 1e-13);
        assert!(log[1..].iter().all(|value| value.abs() < 1e-13));
    }

    #[test]
    fn first_order_for_tiny_blockers() {
        let radius: f64 = 1e-5;
        let blocker = zonal::blocker(4, radius.cos());
        let log = zonal::from_spherical(&logarithm(&zonal::to_spherical(&blocker), DEFAULT_CLIP));
        for (l, cap) in zonal::cap(4, radius.cos()).iter().enumerate() {
            assert!((log[l] / -cap - 1.0).abs() < 1e-4, "{l} {} {cap}", log[l]);
        }
    }
}
