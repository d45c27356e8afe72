//! Tripling coefficients `Γ_ijk = ∫ y_i y_j y_k` of the real basis, exact to f64, for any number of bands.
//!
//! Over complex harmonics the integral is Gaunt's, a product of two Wigner 3j symbols, which `wigners` evaluates in
//! prime factors. The real basis is a unitary mixture of orders ±m, so each real coefficient is a sum of at most four
//! of them. This file is also compiled into the build script that writes the f32 kernels.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use wigners::wigner_3j;

/// One coefficient of the symmetric tensor, with `i <= j <= k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triple {
    /// Smallest index.
    pub i: usize,
    /// Middle index.
    pub j: usize,
    /// Largest index.
    pub k: usize,
    /// `∫ y_i y_j y_k dω`.
    pub value: f64,
}

/// A complex number, as far as the change of basis needs one.
type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// The real `y_l^m` as a mixture of complex harmonics of orders `|m|` and `-|m|`; both have the Condon-Shortley
/// factor, so that `conj(Y^m) = (-1)^m Y^{-m}`.
fn mixture(m: i32) -> Vec<(i32, Complex)> {
    let parity = if m % 2 == 0 { 1.0 } else { -1.0 };
    let h = FRAC_1_SQRT_2;
    match m {
        0 => vec![(0, (1.0, 0.0))],
        1.. => vec![(m, (h, 0.0)), (-m, (parity * h, 0.0))],
        _ => vec![(-m, (0.0, -h)), (m, (0.0, parity * h))],
    }
}

fn degree_and_order(i: usize) -> (usize, i32) {
    let l = i.isqrt();
    (l, i as i32 - (l * (l + 1)) as i32)
}

/// `Γ_ijk = ∫ y_i y_j y_k dω` [Guerrero2007, eq. 3.20] for flat indices in any order; symmetric in them.
///
/// Over complex harmonics `∫ Y Y Y = sqrt((2a+1)(2b+1)(2c+1)/4π)·(a b c; 0 0 0)(a b c; m n p)`. Relative error of a
/// few ulp; exactly 0 where the selection rules say so.
pub fn coefficient(i: usize, j: usize, k: usize) -> f64 {
    let [(a, m), (b, n), (c, p)] = [i, j, k].map(degree_and_order);
    let triangle = c >= a.abs_diff(b) && c <= a + b;
    let sines = [m, n, p].iter().filter(|&&order| order < 0).count();
    let [u, v, w] = [m, n, p].map(i32::abs);
    if !triangle || (a + b + c) % 2 == 1 || sines % 2 == 1 || !(u == v + w || v == u + w || w == u + v) {
        return 0.0;
    }
    let mut sum = 0.0;
    for (m, cm) in mixture(m) {
        for (n, cn) in mixture(n) {
            for (p, cp) in mixture(p) {
                if m + n + p == 0 {
                    let (real, _) = times(times(cm, cn), cp);
                    sum += real * wigner_3j(a as u32, b as u32, c as u32, m, n, p);
                }
            }
        }
    }
    let degrees = ((2 * a + 1) * (2 * b + 1) * (2 * c + 1)) as f64;
    (degrees / (4.0 * PI)).sqrt() * wigner_3j(a as u32, b as u32, c as u32, 0, 0, 0) * sum
}

/// All non-zero coefficients of `bands` bands with `i <= j <= k`, sorted: 77 at 4 bands, which stand for 353 entries of
/// the full tensor.
pub fn distinct(bands: usize) -> Vec<Triple> {
    let count = bands * bands;
    let mut triples = Vec::new();
    for i in 0..count {
        for j in i..count {
            for k in j..count {
                let value = coefficient(i, j, k);
                if value.abs() > ROUNDING {
                    triples.push(Triple { i, j, k, value });
                }
            }
        }
    }
    triples
}

/// A smaller coefficient cancels to zero without a selection rule saying so; the smallest true one within 16 bands is
/// above 1e-4.
pub(crate) const ROUNDING: f64 = 1e-12;

impl Triple {
    /// The entries `(i, j, k)` of the full tensor that this coefficient stands for: 1, 3 or 6.
    pub fn permutations(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let Self { i, j, k, .. } = *self;
        let all = [[i, j, k], [i, k, j], [j, i, k], [j, k, i], [k, i, j], [k, j, i]];
        (0..all.len()).filter(move |&at| !all[..at].contains(&all[at])).map(move |at| all[at])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis;
    use crate::quadrature::SphereQuadrature;

    #[test]
    fn four_bands_have_77_distinct_of_353_entries() {
        let triples = distinct(4);
        assert_eq!(triples.len(), 77);
        assert_eq!(triples.iter().map(|t| t.permutations().count()).sum::<usize>(), 353);
        assert!(triples.is_sorted_by_key(|t| [t.i, t.j, t.k]));
        assert!(triples.iter().all(|t| t.i <= t.j && t.j <= t.k));
    }

    #[test]
    fn coefficients_agree_with_quadrature() {
        let bands = 6;
        let count = basis::coefficient_count(bands);
        let mut integrated = vec![0.0; count * count * count];
        for (direction, weight) in SphereQuadrature::exact_to(3 * (bands - 1)).points() {
            let y = basis::evaluate(bands, direction);
            for i in 0..count {
                for j in 0..count {
                    let scale = weight * y[i] * y[j];
                    let row = &mut integrated[(i * count + j) * count..][..count];
                    row.iter_mut().zip(&y).for_each(|(sum, y)| *sum += scale * y);
                }
            }
        }
        for i in 0..count {
            for j in 0..count {
                for k in 0..count {
                    let difference = coefficient(i, j, k) - integrated[(i * count + j) * count + k];
                    assert!(difference.abs() < 1e-12, "{i} {j} {k}: {difference}");
                }
            }
        }
    }

    #[test]
    fn the_constant_makes_a_dot_product() {
        for i in 0..100 {
            assert!((coefficient(0, i, i) - 1.0 / (4.0 * PI).sqrt()).abs() < 1e-14);
        }
    }
}
