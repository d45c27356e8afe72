//! The real spherical harmonics basis, in f64 for any number of bands.
//!
//! With `n` bands there are `n²` functions of degree `l = 0..n` and order `m = -l..=l`, flattened as
//! `i = l(l+1) + m`. The polar axis is +z. The Condon-Shortley factor `(-1)^m` is inside the associated Legendre
//! polynomials, so that band 1 is `sqrt(3/4π)·(-y, z, -x)` [Guerrero2007, eq. A.1-A.6].

use crate::recurrence::{legendre_step, sectoral_constant};
use std::f64::consts::PI;

/// Number of coefficients of `bands` bands: `bands²`.
pub const fn coefficient_count(bands: usize) -> usize {
    bands * bands
}

/// Flat index of degree `l` and order `m`: `l(l+1) + m` [Guerrero2007, 3.1].
///
/// `m` must lie in `-l..=l`.
pub const fn index(l: usize, m: isize) -> usize {
    (l * (l + 1)).strict_add_signed(m)
}

/// Degree and order of flat index `i`: the inverse of [`index`].
pub const fn degree_and_order(i: usize) -> (usize, isize) {
    let l = i.isqrt();
    (l, i as isize - (l * (l + 1)) as isize)
}

/// Number of bands of a vector with `coefficients` entries, or `None` if that is no square.
pub const fn bands_of(coefficients: usize) -> Option<usize> {
    let bands = coefficients.isqrt();
    if bands * bands == coefficients { Some(bands) } else { None }
}

/// All basis functions of `bands` bands along unit `direction`.
///
/// `y_l^m = sqrt(2) N_l^m P_l^m(z)·{cos mφ, sin |m|φ}` for m > 0 and m < 0, `N_l^0 P_l^0(z)` for m = 0
/// [Guerrero2007, eq. A.6]. No trigonometry: `(1-z²)^{m/2} (cos mφ, sin mφ)` is the complex power `(x + iy)^m`.
/// Accurate to a few ulp times the number of bands.
pub fn evaluate(bands: usize, direction: [f64; 3]) -> Vec<f64> {
    let mut values = vec![0.0; coefficient_count(bands)];
    evaluate_into(bands, direction, &mut values);
    values
}

/// As [`evaluate`], into `values`, which must hold `bands²` entries.
///
/// # Panics
/// If `values` has another length.
pub fn evaluate_into(bands: usize, direction: [f64; 3], values: &mut [f64]) {
    assert_eq!(values.len(), coefficient_count(bands), "one value per basis function");
    let [x, y, z] = direction;
    let (mut cosine, mut sine) = (1.0, 0.0);
    for m in 0..bands {
        let order = m as isize;
        let (mut below, mut current) = (0.0, sectoral_constant(m));
        for l in m..bands {
            if l > m {
                let (alpha, beta) = legendre_step(l, m);
                (below, current) = (current, alpha * z * current - beta * below);
            }
            values[index(l, order)] = current * cosine;
            if m > 0 {
                values[index(l, -order)] = current * sine;
            }
        }
        (cosine, sine) = (x * cosine - y * sine, x * sine + y * cosine);
    }
}

/// The constant function 1 as an SH vector: `(sqrt(4π), 0, ..)` [Guerrero2007, eq. 3.25].
pub fn one(bands: usize) -> Vec<f64> {
    let mut unit = vec![0.0; coefficient_count(bands)];
    unit[0] = (4.0 * PI).sqrt();
    unit
}

/// Value of the SH function `coefficients` along unit `direction` [Guerrero2007, eq. 3.2].
///
/// # Panics
/// If the length of `coefficients` is no square.
pub fn reconstruct(coefficients: &[f64], direction: [f64; 3]) -> f64 {
    let bands = bands_of(coefficients.len()).expect("an SH vector has bands² coefficients");
    dot(coefficients, &evaluate(bands, direction))
}

/// Integral of the product of two SH functions: the dot product [Guerrero2007, eq. 3.4]. Where one has more bands,
/// its further coefficients meet zeros.
pub fn dot(f: &[f64], g: &[f64]) -> f64 {
    f.iter().zip(g).map(|(f, g)| f * g).sum()
}

/// `sqrt(Σ f_i²)`.
pub fn magnitude(f: &[f64]) -> f64 {
    dot(f, f).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::SphereQuadrature;

    /// The Legendre polynomials with the factorials written out, as [Guerrero2007, A] has them.
    fn by_definition(l: usize, m: isize, [x, y, z]: [f64; 3]) -> f64 {
        let order = m.unsigned_abs();
        let double_factorial: f64 = (1..=order).map(|k| (2 * k - 1) as f64).product();
        let sign = if order % 2 == 1 { -1.0 } else { 1.0 };
        let (mut below, mut current) = (0.0, sign * double_factorial * (1.0 - z * z).powf(order as f64 / 2.0));
        for k in order + 1..=l {
            let next = (z * (2 * k - 1) as f64 * current - (k + order - 1) as f64 * below) / (k - order) as f64;
            (below, current) = (current, next);
        }
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let normalization = ((2 * l + 1) as f64 / (4.0 * PI) * factorial(l - order) / factorial(l + order)).sqrt();
        let azimuth = y.atan2(x);
        normalization
            * current
            * match m {
                0 => 1.0,
                1.. => (m as f64 * azimuth).cos() * 2f64.sqrt(),
                _ => (-m as f64 * azimuth).sin() * 2f64.sqrt(),
            }
    }

    #[test]
    fn agrees_with_the_definition() {
        for direction in [[0.6, 0.0, 0.8], [0.36, -0.48, 0.8], [-0.64, 0.48, -0.6]] {
            let values = evaluate(9, direction);
            for (i, value) in values.iter().enumerate() {
                let (l, m) = degree_and_order(i);
                assert!((value - by_definition(l, m, direction)).abs() < 1e-13, "l {l} m {m}");
            }
        }
    }

    #[test]
    fn first_band_is_minus_y_z_minus_x() {
        let scale = (3.0 / (4.0 * PI)).sqrt();
        let values = evaluate(2, [0.36, -0.48, 0.8]);
        for (value, expected) in values[1..].iter().zip([0.48, 0.8, -0.36]) {
            assert!((value - scale * expected).abs() < 1e-15);
        }
    }

    #[test]
    fn orthonormal_at_eight_bands() {
        let bands = 8;
        let count = coefficient_count(bands);
        let mut gram = vec![0.0; count * count];
        for (direction, weight) in SphereQuadrature::exact_to(2 * (bands - 1)).points() {
            let values = evaluate(bands, direction);
            for i in 0..count {
                for j in 0..count {
                    gram[i * count + j] += weight * values[i] * values[j];
                }
            }
        }
        for i in 0..count {
            for j in 0..count {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((gram[i * count + j] - expected).abs() < 1e-12, "{i} {j}: {}", gram[i * count + j]);
            }
        }
    }

    #[test]
    fn index_round_trips() {
        for i in 0..400 {
            let (l, m) = degree_and_order(i);
            assert!(m.unsigned_abs() <= l);
            assert_eq!(index(l, m), i);
        }
        assert_eq!((bands_of(64), bands_of(15)), (Some(8), None));
    }
}
