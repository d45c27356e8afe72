//! Quadrature over the sphere, and projection by it.

use crate::basis;
use gauss_quad::GaussLegendre;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

/// π (3 - √5), the angle whose multiples fill a circle evenly, however many there are.
pub const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// `count` unit directions of equal area 4π/count, on a spiral about the y axis that turns by the golden angle.
pub fn golden_spiral(count: usize) -> impl ExactSizeIterator<Item = [f64; 3]> {
    (0..count).map(move |i| {
        let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (sin, cos) = (GOLDEN_ANGLE * i as f64).sin_cos();
        let ring = (1.0 - y * y).max(0.0).sqrt();
        [ring * cos, y, ring * sin]
    })
}

/// Gauss-Legendre points in cos θ times equally spaced points in φ.
///
/// Exact for polynomials in (x, y, z) up to the degree asked for, hence for SH of that degree. For functions with
/// jumps the error falls with the inverse of the degree only.
#[derive(Debug, Clone)]
pub struct SphereQuadrature {
    cosines: Vec<(f64, f64)>,
    azimuths: Vec<(f64, f64)>,
}

impl SphereQuadrature {
    /// The smallest product rule that is exact to polynomial `degree`: `degree/2 + 1` by `degree + 1` points.
    pub fn exact_to(degree: usize) -> Self {
        let azimuth_count = degree + 1;
        Self {
            cosines: gauss_legendre(degree / 2 + 1, -1.0, 1.0),
            azimuths: (0..azimuth_count)
                .map(|k| (TAU * (k as f64 + 0.5) / azimuth_count as f64).sin_cos())
                .map(|(sine, cosine)| (cosine, sine))
                .collect(),
        }
    }

    /// Every point as (unit direction, weight in steradians); weights are positive and add up to 4π.
    pub fn points(&self) -> impl Iterator<Item = ([f64; 3], f64)> + '_ {
        let share = TAU / self.azimuths.len() as f64;
        self.cosines.iter().flat_map(move |&(z, weight)| {
            let sine = ((1.0 - z) * (1.0 + z)).sqrt();
            self.azimuths.iter().map(move |&(c, s)| ([sine * c, sine * s, z], weight * share))
        })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.cosines.len() * self.azimuths.len()
    }

    /// Never: a rule has at least one point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// `∫ f dω` over the sphere.
    pub fn integrate(&self, f: impl Fn([f64; 3]) -> f64) -> f64 {
        self.points().map(|(direction, weight)| weight * f(direction)).sum()
    }

    /// SH vector of `f`: `∫ f(s) y(s) ds` [Guerrero2007, eq. 3.5], without Monte Carlo noise. Exact if `f` is a
    /// polynomial of degree d and the rule exact to `d + bands - 1`.
    pub fn project(&self, bands: usize, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
        let mut coefficients = vec![0.0; basis::coefficient_count(bands)];
        let mut values = coefficients.clone();
        for (direction, weight) in self.points() {
            basis::evaluate_into(bands, direction, &mut values);
            let scale = weight * f(direction);
            coefficients.iter_mut().zip(&values).for_each(|(c, y)| *c += scale * y);
        }
        coefficients
    }
}

/// Gauss-Legendre nodes and weights on `[a, b]`: exact for polynomials of degree `2·count - 1`. `count` 0 counts as 1.
pub(crate) fn gauss_legendre(count: usize, a: f64, b: f64) -> Vec<(f64, f64)> {
    let rule = GaussLegendre::new(NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN));
    let (half, middle) = (0.5 * (b - a), 0.5 * (a + b));
    rule.iter().map(|&(node, weight)| (middle + half * node, half * weight)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_are_exact() {
        let rule = SphereQuadrature::exact_to(6);
        let four_pi = 2.0 * TAU;
        assert!((rule.integrate(|_| 1.0) - four_pi).abs() < 1e-13);
        assert!((rule.integrate(|[x, y, z]| x * x * y * y * z * z) - four_pi / 105.0).abs() < 1e-14);
        assert!((rule.integrate(|[x, ..]| x.powi(6)) - four_pi / 7.0).abs() < 1e-13);
        assert!(rule.integrate(|[x, y, _]| x * x * x * y).abs() < 1e-14);
        assert_eq!(rule.points().count(), rule.len());
    }

    #[test]
    fn projection_returns_the_coefficients() {
        let expected: Vec<f64> = (0..36).map(|i| ((i * i) as f64).sin()).collect();
        let rule = SphereQuadrature::exact_to(10);
        let projected = rule.project(6, |direction| basis::reconstruct(&expected, direction));
        for (p, e) in projected.iter().zip(&expected) {
            assert!((p - e).abs() < 1e-13);
        }
    }
}
