//! The lobe that stands for a cap of directions, such as a sphere covers.
//!
//! With z0 = cos θ of the angular radius θ in [0, π/2], n = e + 1 and `u = z0^n`, everything is closed form:
//! `∫ c = 2π s/n`, `∫ c² = 2π s²/(2n-1)`, and over the cap `∫ c = 2π s (1-u)/n`. Written in n and the versine
//! `v = 1 - z0`, n v depends on v smoothly and has a limit for small caps, where `n ≈ 2 n v/θ²`.

use super::{Lobe, MAX_EXPONENT};
use std::f64::consts::TAU;

/// Rule by which a lobe stands for a cap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CapFit {
    /// Scale 1, exponent by least squares over the sphere [Meunier2009, eq. 31-34].
    ///
    /// `∫_cap cos^e ln cos = ∫ cos^(2e) ln cos` is `u (1 - ln u) = 1 - n²/(2n-1)²`. Small caps: `n ≈ 1.923/θ²`. Its
    /// integral is 4 % more than the cap's for small caps, right at 0.6 rad, and up to 7 % less at 1.3 rad.
    #[default]
    LeastSquares,
    /// Exponent and scale by least squares: `-u ln u/(1-u) = (n-1)/(2n-1)`, `s = (2n-1)/n·(1-u)`.
    ///
    /// Small caps: `n ≈ 2.513/θ²`, s ≈ 1.431, the integral 14 % more than the cap's.
    LeastSquaresScaled,
    /// Scale 1 and the exponent that gives the lobe the cap's solid angle: `n = 1/v`. Small caps: `n ≈ 2/θ²`.
    SolidAngle,
    /// The exponent of [`LeastSquaresScaled`](Self::LeastSquaresScaled) and the scale that gives the lobe the cap's solid
    /// angle: `s = n v`. Small caps: s ≈ 1.256.
    ScaledSolidAngle,
}

impl CapFit {
    /// Every fit.
    pub const ALL: [Self; 4] = [Self::LeastSquares, Self::LeastSquaresScaled, Self::SolidAngle, Self::ScaledSolidAngle];

    /// Whether the lobe has the solid angle of the cap.
    pub fn keeps_solid_angle(self) -> bool {
        matches!(self, Self::SolidAngle | Self::ScaledSolidAngle)
    }

    /// (n v, s) for a versine in [0, 1]: to 1e-12. The limit at v = 0 is taken a little above it.
    pub(super) fn ratios(self, versine: f64) -> (f64, f64) {
        let v = versine.clamp(1e-9, 1.0);
        if v == 1.0 || self == Self::SolidAngle {
            return (1.0, 1.0);
        }
        let ln_z0 = (-v).ln_1p();
        let u = |n: f64| (n * ln_z0).exp();
        match self {
            Self::SolidAngle => (1.0, 1.0),
            Self::LeastSquares => {
                // The left side falls with n, the right one rises.
                let n = root(v, |n| {
                    let half = n / (2.0 * n - 1.0);
                    u(n) * (1.0 - n * ln_z0) - (1.0 - half * half)
                });
                (n * v, 1.0)
            }
            Self::LeastSquaresScaled | Self::ScaledSolidAngle => {
                let n = root(v, |n| -u(n) * n * ln_z0 / -(n * ln_z0).exp_m1() - (n - 1.0) / (2.0 * n - 1.0));
                let scale = match self {
                    Self::LeastSquaresScaled => (2.0 * n - 1.0) / n * (1.0 - u(n)),
                    _ => n * v,
                };
                (n * v, scale)
            }
        }
    }
}

/// Root of a falling function of n in [1, 2/v].
fn root(v: f64, falling: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, (2.0 / v).ln());
    for _ in 0..50 {
        let middle: f64 = 0.5 * (low + high);
        if falling(middle.exp()) > 0.0 { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

/// The lobe for the cap of angular radius θ about a unit axis, with value 1 in the cap.
///
/// `versine = 1 - cos θ`, [0, 2]; NaN counts as 0. A cap of nothing has scale 0, and one so small that its exponent
/// would pass [`MAX_EXPONENT`] keeps the integral by a smaller scale. A lobe ends at the hemisphere: past π/2 the
/// exponent is 0, the scale 1 or, where the solid angle is kept, the versine.
///
/// Error, as the squared distance over the cap's solid angle: 0.235 for small caps by [`CapFit::LeastSquares`], 0.185
/// with the scale fitted too, 0.236 and 0.198 where the solid angle is kept; falling to 0 for a hemisphere.
pub fn cap_lobe(axis: [f64; 3], versine: f64, fit: CapFit) -> Lobe {
    // Not `clamp`, which keeps NaN.
    let versine = if versine > 0.0 { versine.min(2.0) } else { 0.0 };
    let (nv, s) = fit.ratios(versine);
    let wide = if fit.keeps_solid_angle() { versine.max(1.0) } else { 1.0 };
    // n = nv/v, but never above the largest: the scale takes the rest.
    let largest = MAX_EXPONENT + 1.0;
    let shrink = (versine.min(1.0) * largest / nv).min(1.0);
    let n = if shrink < 1.0 { largest } else { nv / versine.min(1.0) };
    Lobe { axis, exponent: (n - 1.0).max(0.0), scale: s * wide * shrink }
}

/// `∫ (cap - c)² dω` over the cap's solid angle, for a cap of versine v in (0, 1] and a lobe about its axis.
pub fn cap_distance(versine: f64, lobe: &Lobe) -> f64 {
    let n = lobe.exponent + 1.0;
    let inside = -(n * (-versine).ln_1p()).exp_m1() / n;
    let square = versine - 2.0 * lobe.scale * inside + lobe.scale * lobe.scale / (2.0 * n - 1.0);
    TAU * square / (TAU * versine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn versine(radius: f64) -> f64 {
        2.0 * (0.5 * radius).sin().powi(2)
    }

    fn lobe(radius: f64, fit: CapFit) -> Lobe {
        cap_lobe([0.0, 0.0, 1.0], versine(radius), fit)
    }

    /// `∫ (cap - s cos^e)² dω` by quadrature in θ, split at the cap's edge.
    fn distance(rule: &[(f64, f64)], radius: f64, exponent: f64, scale: f64) -> f64 {
        let part = |from: f64, to: f64, cap: f64| {
            let at = |&(t, weight): &(f64, f64)| {
                let theta = from + (to - from) * t;
                weight * (to - from) * TAU * theta.sin() * (cap - scale * theta.cos().powf(exponent)).powi(2)
            };
            rule.iter().map(at).sum::<f64>()
        };
        let reach = FRAC_PI_2.min(8.0 * radius);
        part(0.0, radius, 1.0) + part(radius, reach, 0.0)
    }

    /// Golden section.
    fn minimum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..80 {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            if f(left) < f(right) { high = right } else { low = left }
        }
        0.5 * (low + high)
    }

    #[test]
    fn exponents_are_those_of_a_search_with_quadrature() {
        let rule = gauss_legendre(100, 0.0, 1.0);
        for radius in [0.02, 0.2, 0.7, 1.2, 1.5] {
            let published = lobe(radius, CapFit::LeastSquares);
            let found = minimum(0.0, 4.0, |ln| distance(&rule, radius, ln_to_exponent(ln, radius), 1.0));
            let found = ln_to_exponent(found, radius);
            assert!((found - published.exponent).abs() < 1e-5 * (1.0 + found), "{radius}: {found} {published:?}");
            let relative = distance(&rule, radius, published.exponent, 1.0) / (TAU * versine(radius));
            assert!((cap_distance(versine(radius), &published) / relative - 1.0).abs() < 1e-6);

            let both = lobe(radius, CapFit::LeastSquaresScaled);
            let best = distance(&rule, radius, both.exponent, both.scale);
            for (e, s) in [(1.01, 1.0), (0.99, 1.0), (1.0, 1.01), (1.0, 0.99), (1.01, 1.01), (0.99, 0.99)] {
                assert!(distance(&rule, radius, both.exponent * e, both.scale * s) > best, "{radius} {e} {s}");
            }
        }
    }

    /// A variable in which the minimum is round: the exponent over 1/θ², by logarithm.
    fn ln_to_exponent(ln: f64, radius: f64) -> f64 {
        (ln.exp() - 1.0) / (radius * radius)
    }

    #[test]
    fn limits_of_small_caps() {
        let scaled = |fit| {
            let lobe = lobe(1e-3, fit);
            ((lobe.exponent + 1.0) * 1e-6, lobe.scale)
        };
        let close = |(n, s): (f64, f64), expected: (f64, f64)| {
            assert!((n - expected.0).abs() < 1e-3 && (s - expected.1).abs() < 1e-3, "{n} {s}");
        };
        close(scaled(CapFit::LeastSquares), (1.9232, 1.0));
        close(scaled(CapFit::LeastSquaresScaled), (2.5129, 1.4307));
        close(scaled(CapFit::SolidAngle), (2.0, 1.0));
        close(scaled(CapFit::ScaledSolidAngle), (2.5129, 1.2564));
    }

    /// Errors of the fits, and the volume that they keep: the figures in the documentation.
    #[test]
    fn fits_compare_as_documented() {
        for radius in [1e-3, 0.1, 0.5, 1.0, 1.4] {
            let v = versine(radius);
            let found = CapFit::ALL.map(|fit| {
                let lobe = lobe(radius, fit);
                (cap_distance(v, &lobe), lobe.integral() / (TAU * v))
            });
            let [published, scaled, solid, scaled_solid] = found;
            assert!(scaled.0 <= published.0 && published.0 <= solid.0 && scaled.0 <= scaled_solid.0, "{found:?}");
            assert!((solid.1 - 1.0).abs() < 1e-9 && (scaled_solid.1 - 1.0).abs() < 1e-9);
            assert!(published.1 > 0.93 && published.1 < 1.0403 && scaled.1 > 1.0 && scaled.1 < 1.139, "{found:?}");
            assert!(published.0 < 0.236 && solid.0 < 0.237 && scaled.0 < 0.186 && scaled_solid.0 < 0.199, "{found:?}");
        }
    }

    #[test]
    fn extremes_are_defined() {
        for fit in CapFit::ALL {
            assert_eq!(lobe(0.0, fit).scale, 0.0);
            assert_eq!(cap_lobe([0.0; 3], f64::NAN, fit).scale, 0.0);
            let half = lobe(FRAC_PI_2, fit);
            assert!(half.exponent < 1e-9 && (half.scale - 1.0).abs() < 1e-9, "{fit:?} {half:?}");
            for radius in [1e-9, 1e-5, 1e-4, 0.3, 2.0, PI] {
                let lobe = lobe(radius, fit);
                assert!(lobe.exponent.is_finite() && lobe.exponent <= MAX_EXPONENT && lobe.scale > 0.0);
                let ratio = lobe.integral() / (TAU * versine(radius));
                assert!(!fit.keeps_solid_angle() || (ratio - 1.0).abs() < 1e-6, "{fit:?} {radius}: {ratio}");
            }
            // Exponents fall as caps grow.
            let exponents: Vec<f64> = (1..=100).map(|i| lobe(FRAC_PI_2 * f64::from(i) / 100.0, fit).exponent).collect();
            assert!(exponents.windows(2).all(|pair| pair[1] < pair[0]));
        }
    }
}
