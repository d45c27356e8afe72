//! Constants of the recurrences that evaluate the basis; compiled into the build script as well.

use std::f64::consts::{PI, SQRT_2};

/// `(alpha, beta)` of `P_l^m(z) = alpha·z·P_{l-1}^m(z) - beta·P_{l-2}^m(z)`, where every `P_l^m` carries the
/// normalization `N_l^m` of [Guerrero2007, eq. A.5]: their eq. A.1, rescaled. Needs `l > m`; beta is 0 at l = m+1.
pub(crate) fn legendre_step(l: usize, m: usize) -> (f64, f64) {
    let (l, m) = (l as f64, m as f64);
    let alpha = ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
    if l <= m + 1.0 {
        return (alpha, 0.0);
    }
    let below = l - 1.0;
    (alpha, alpha * ((below * below - m * m) / (4.0 * below * below - 1.0)).sqrt())
}

/// `N_m^m P_m^m(z)/(1-z²)^{m/2}`, a constant, times `sqrt(2)` for `m > 0` as the real basis wants it
/// [Guerrero2007, eq. A.2, A.5, A.6].
pub(crate) fn sectoral_constant(m: usize) -> f64 {
    let mut value = (1.0 / (4.0 * PI)).sqrt();
    for k in 1..=m {
        value *= -((2 * k + 1) as f64 / (2 * k) as f64).sqrt();
    }
    if m > 0 { value * SQRT_2 } else { value }
}
