//! The product of two lobes as a lobe, its integral, and a bound of it: the f64 reference.
//!
//! Two points between the axes matter. The *peak* is where the product is largest: the axis of [Meunier2009, eq. 18],
//! found there by Nelder-Mead, here in closed form. It moves onto a lobe's edge as that lobe's exponent vanishes. The
//! *balanced* point is the peak for exponents larger by one: it stays inside, and in the variable
//! `ln(cos ψ / cos(α-ψ))` it is where the integrand of the integral is largest. With g of the balanced point ([`Pair`]),
//! `P = cos(x)^e1 cos(α-x)^e2` there and `E = e1 + e2`,
//!
//! `∫ ≈ 2πP c/n`, `n = sqrt((E+1)((E+2)/g - 1))`,
//! `c = 1 + (1/12)(1-g)(1+g+10g²)·(e1-e2)²/((e1+1)(e2+1)(E+2))`.
//!
//! This is Laplace's method in that variable, with c from the third and fourth derivatives, made exact at α = 0. It is
//! 14 % too large for two hemispheres at right angles, 4 % too small where one lobe is narrow and the other's exponent
//! 0, within 3 % where both exponents are 1 or more, and exact as both grow. n - 1 is also the exponent that least
//! squares finds as exponents grow: the geometric mean of a Gaussian's two precisions.

use super::fit::{Fit, least_squares};
use super::pair::{HalfAngle, Saddle, unit};
use super::plane::{Plane, ln_wallis};
use super::{Lobe, finite_exponent};
use crate::basis::dot;
use std::f64::consts::{FRAC_PI_2, TAU};

/// How a product of two lobes becomes a lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ProductRule {
    /// Axis at the peak, exponent and scale by least squares over the sphere [Meunier2009, eq. 15-19].
    #[default]
    Published,
    /// Axis and exponent as published, and the scale that makes the lobe's integral that of the product.
    IntegralPreserving,
    /// Axis along the product's mean vector `∫ v c1 c2 dω`, exponent and scale so that integral and mean vector are the
    /// product's: `(e+1)/(e+2)` is the mean vector's length over the integral. Another product with a lobe that is nearly
    /// linear over this one is then right to first order.
    Moments,
}

impl ProductRule {
    /// Every rule.
    pub const ALL: [Self; 3] = [Self::Published, Self::IntegralPreserving, Self::Moments];
}

/// Exponents and angle of a product, and what all rules need of them.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    e1: f64,
    e2: f64,
    angle: HalfAngle,
    pub(super) balanced: Saddle,
    pub(super) plane: Plane,
}

impl Pair {
    pub(super) fn new(e1: f64, e2: f64, angle: HalfAngle) -> Self {
        let balanced = Saddle::new(e1 + 1.0, e2 + 1.0, angle);
        Self { e1, e2, angle, balanced, plane: Plane::new(e1, e2, &balanced) }
    }

    /// n above. Infinite for opposite axes.
    pub(super) fn n(&self) -> f64 {
        let sum = self.e1 + self.e2;
        ((sum + 1.0) * ((sum + 2.0) / self.balanced.g() - 1.0)).sqrt()
    }

    /// The closed form of [`relative_integral`](Self::relative_integral): `2π c/n`.
    pub(super) fn estimate(&self) -> f64 {
        let (f1, f2) = (self.e1 + 1.0, self.e2 + 1.0);
        let g = self.balanced.g();
        let skew = (f1 - f2).powi(2) / (f1 * f2 * (f1 + f2));
        TAU / self.n() * (1.0 + skew * (1.0 - g) * (1.0 + g + 10.0 * g * g) / 12.0)
    }

    /// `∫ max(a·v,0)^e1 max(b·v,0)^e2 dω` over the value at the balanced point.
    pub(super) fn relative_integral(&self) -> f64 {
        self.plane.total() * ln_wallis(self.e1 + self.e2 + 1.0).exp()
    }

    /// About the peak; the scale is relative to the value at the balanced point.
    pub(super) fn least_squares(&self) -> Fit {
        least_squares(self.e1, self.e2, &self.plane, self.peak().to_edges().1)
    }

    fn peak(&self) -> Saddle {
        Saddle::new(self.e1, self.e2, self.angle)
    }

    /// The longitude of the mean vector from where the second lobe ends, and 1 plus the exponent of the lobe with its
    /// length.
    pub(super) fn moments(&self) -> (f64, f64) {
        let middle = self.balanced.to_edges().1;
        let points = || self.plane.longitudes.iter().zip(&self.plane.masses);
        let (sine, cosine) = points().fold((0.0, 0.0), |(sine, cosine), (longitude, mass)| {
            let (s, c) = (longitude - middle).sin_cos();
            (sine + mass * s, cosine + mass * c)
        });
        let longitude = middle + sine.atan2(cosine);
        // One less the length, in the plane and across it: small for narrow lobes, so not by a difference.
        let lack = |(angle, mass): (&f64, &f64)| 2.0 * mass * (0.5 * (angle - longitude)).sin().powi(2);
        let along = points().map(lack).sum::<f64>() / self.plane.total();
        let sum = self.e1 + self.e2;
        let across = -(ln_wallis(sum + 2.0) - ln_wallis(sum + 1.0)).exp_m1();
        (longitude, 1.0 / (along + across - along * across) - 1.0)
    }

    /// τ such that the mean vector points at the peak for exponents larger by τ; undefined for equal exponents or axes.
    ///
    /// A peak at the angle x from the first axis has `sin(2x-α) = k sin α` ([`Saddle`]), for the exponents asked for with
    /// `k = (e2-e1)/(e1+e2+2τ)`.
    pub(super) fn shift(&self) -> f64 {
        let (z, y) = self.balanced.to_edges();
        // 2x - α, from longitudes that count from where the second lobe ends.
        let longitude = self.moments().0;
        let k = ((longitude - y) + (longitude - z)).sin() / self.angle.sine();
        0.5 * ((self.e2 - self.e1) / k - (self.e1 + self.e2))
    }

    /// Value at the balanced point; 0 where the two lobes have no direction in common.
    fn value(&self) -> f64 {
        self.plane.ln_value.exp()
    }
}

/// The pair of two lobes, or `None` where their product is 0 everywhere.
fn pair(a: &Lobe, b: &Lobe) -> Option<Pair> {
    let (e1, e2) = (finite_exponent(a.exponent), finite_exponent(b.exponent));
    let pair = Pair::new(e1, e2, HalfAngle::between(a.axis, b.axis));
    (pair.n().is_finite() && pair.plane.total() > 0.0).then_some(pair)
}

/// `a·b` as a lobe, fitted directly. [`LobeTable`](super::LobeTable) has it tabulated.
///
/// Lobes of opposite axes, or so narrow and far apart that nothing of the product is left in f64, give scale 0. Axes
/// need not be normalized; exponents are clamped to [0, [`MAX_EXPONENT`](super::MAX_EXPONENT)]. Every rule keeps a lobe
/// that is multiplied by one of exponent 0 only where the other's hemisphere covers it: a hemisphere, not the constant
/// 1 of [Meunier2009, eq. 40].
///
/// The published rule misses up to 16 % of the integral where axes are within 0.1 of a right angle, half and more as they
/// become opposite; the others keep it. [`accuracy`](super::accuracy) measures it.
pub fn product(a: &Lobe, b: &Lobe, rule: ProductRule) -> Lobe {
    let Some(pair) = pair(a, b) else {
        return Lobe { axis: unit(a.axis), exponent: finite_exponent(a.exponent + b.exponent), scale: 0.0 };
    };
    let (first, second) = (unit(a.axis), unit(b.axis));
    let preserving = |exponent: f64| pair.relative_integral() * (exponent + 1.0) / TAU;
    let (axis, exponent, scale) = match rule {
        ProductRule::Published | ProductRule::IntegralPreserving => {
            let fit = pair.least_squares();
            let exponent = finite_exponent(fit.exponent);
            let scale = if rule == ProductRule::Published { fit.scale } else { preserving(exponent) };
            (pair.peak().direction(first, second), exponent, scale)
        }
        ProductRule::Moments => {
            let (longitude, n) = pair.moments();
            let exponent = finite_exponent(n - 1.0);
            let (z, y) = pair.balanced.to_edges();
            // As a turn from the first axis toward the second, defined for equal axes too.
            let turn = FRAC_PI_2 - (z + (y - longitude));
            let along = dot(&first, &second);
            let side = unit(std::array::from_fn(|axis| second[axis] - along * first[axis]));
            let axis = unit(std::array::from_fn(|axis| turn.cos() * first[axis] + turn.sin() * side[axis]));
            (axis, exponent, preserving(exponent))
        }
    };
    Lobe { axis, exponent, scale: a.scale * b.scale * scale * pair.value() }
}

/// `∫ a(v) b(v) dω` over the sphere, in steradians times the unit of the scales: relative error 1e-9.
///
/// By quadrature of one dimension, `plane.rs`. In closed form, with p = cos²(α/2), it is
/// `W(E+1) 2^(E+1) p^((E+1)/2) B(e1+1, e2+1) F((1+e1-e2)/2, (1-e1+e2)/2; (E+3)/2; p)`, W the integral of a power of
/// the cosine and F Gauss' hypergeometric function, whose series cancels badly for exponents far apart.
pub fn product_integral(a: &Lobe, b: &Lobe) -> f64 {
    pair(a, b).map_or(0.0, |pair| a.scale * b.scale * pair.value() * pair.relative_integral())
}

/// A bound that `|∫ a(v) b(v) dω|` never exceeds: `|s1 s2| cos(x)^e1 cos(α-x)^e2 · 2π/(e1+e2+1)`, x the peak.
///
/// For any direction, at the angle δ from the peak, the product is at most its peak value times `cos^(e1+e2) δ`: with t
/// = tan of the longitude from the peak, `cos ψ = cos x cos(ψ-x) (1 - t tan x)`, and `(1 - t tan x)^e1 (1 + t
/// tan(α-x))^e2 ≤ exp(t (e2 tan(α-x) - e1 tan x)) = 1`. So a product may be dropped as [Meunier2009, 4.3] does, by a
/// threshold on this, without a fit and without ever dropping what isn't negligible. Equal to the integral for equal
/// axes; for others too large by about `1/sqrt(g)`.
pub fn product_bound(a: &Lobe, b: &Lobe) -> f64 {
    let (e1, e2) = (finite_exponent(a.exponent), finite_exponent(b.exponent));
    let peak = Saddle::new(e1, e2, HalfAngle::between(a.axis, b.axis));
    (a.scale * b.scale).abs() * peak.ln_value(e1, e2).exp() * TAU / (e1 + e2 + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::PI;

    fn lobes(e1: f64, e2: f64, alpha: f64) -> (Lobe, Lobe) {
        let (sine, cosine) = alpha.sin_cos();
        (
            Lobe { axis: [0.0, 0.6, 0.8], exponent: e1, scale: 1.0 },
            Lobe { axis: [sine, 0.6 * cosine, 0.8 * cosine], exponent: e2, scale: 1.0 },
        )
    }

    /// `∫ a b dω` in polar coordinates about a, split where b's hemisphere begins to cut the parallels and ending at its
    /// edge: shares nothing with the quadrature in the plane.
    fn polar(e1: f64, e2: f64, alpha: f64) -> f64 {
        let rule = gauss_legendre(80, 0.0, 1.0);
        let parallel = |theta: f64| {
            let (mean, swing) = (theta.cos() * alpha.cos(), theta.sin() * alpha.sin());
            let end = (-mean / swing).clamp(-1.0, 1.0).acos();
            // φ = end·(1 - s²) takes the root out of the edge.
            let at = |&(s, weight): &(f64, f64)| {
                let cosine = mean + swing * (end * (1.0 - s * s)).cos();
                weight * 2.0 * s * end * cosine.max(0.0).powf(e2)
            };
            2.0 * rule.iter().map(at).sum::<f64>()
        };
        let split = (FRAC_PI_2 - alpha).abs();
        let part = |from: f64, to: f64| {
            // Both ends flattened, for roots there.
            let at = |&(s, weight): &(f64, f64)| {
                let theta = from + (to - from) * s * s * (3.0 - 2.0 * s);
                weight * 6.0 * s * (1.0 - s) * (to - from) * theta.cos().powf(e1) * theta.sin() * parallel(theta)
            };
            rule.iter().map(at).sum::<f64>()
        };
        part(0.0, split) + part(split, FRAC_PI_2)
    }

    #[test]
    fn integrals_agree_with_polar_quadrature() {
        for (e1, e2) in [(0.0, 0.0), (0.5, 0.1), (1.0, 1.0), (1.0, 0.3), (3.0, 12.0), (40.0, 1.0), (60.0, 50.0)] {
            for alpha in [0.2, 1.0, 1.5, 1.6, 2.4, 3.0] {
                let (a, b) = lobes(e1, e2, alpha);
                let (found, expected) = (product_integral(&a, &b), polar(e1, e2, alpha));
                assert!((found - expected).abs() < 1e-5 * expected, "{e1} {e2} {alpha}: {found} {expected}");
                assert!((product_integral(&b, &a) / found - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn closed_forms() {
        // Two hemispheres: a lune. Two cosines [Meunier2009, eq. 26 twice]: 2/3·((π-α) cos α + sin α).
        for alpha in [0.0, 0.3, 1.6, 3.0, PI] {
            let (a, b) = lobes(0.0, 0.0, alpha);
            assert!((product_integral(&a, &b) - 2.0 * (PI - alpha)).abs() < 1e-7);
            let (a, b) = lobes(1.0, 1.0, alpha);
            let cosines = 2.0 / 3.0 * ((PI - alpha) * alpha.cos() + alpha.sin());
            assert!((product_integral(&a, &b) - cosines).abs() < 1e-7, "{alpha}");
        }
    }

    /// Hypergeometric series where it doesn't cancel: exponents close to each other.
    #[test]
    fn integral_is_hypergeometric() {
        for (e1, e2, alpha) in [(2.0, 2.0, 1.0), (3.3, 2.9, 2.0), (0.4, 1.0, 1.8), (30.0, 29.5, 0.7), (5.0, 3.0, 2.9)] {
            let (p, sum) = ((1.0 + f64::cos(alpha)) / 2.0, e1 + e2);
            let (a, b, c) = ((1.0 + e1 - e2) / 2.0, (1.0 - e1 + e2) / 2.0, (sum + 3.0) / 2.0);
            let (mut term, mut series) = (1.0, 0.0);
            for k in 0..2000 {
                series += term;
                let k = f64::from(k);
                term *= (a + k) * (b + k) / ((c + k) * (k + 1.0)) * p;
            }
            let beta = gauss_legendre(200, 0.0, 1.0)
                .iter()
                .map(|&(t, w)| {
                    // t³ takes fractional powers at the ends to where the rule is exact enough.
                    let (x, y) = (t * t * t, 1.0 - t * t * t);
                    w * 3.0 * t * t * x.powf(e1) * y.powf(e2)
                })
                .sum::<f64>();
            let expected = ln_wallis(sum + 1.0).exp() * (4.0 * p).powf((sum + 1.0) / 2.0) * beta * series;
            let (a, b) = lobes(e1, e2, alpha);
            assert!((product_integral(&a, &b) / expected - 1.0).abs() < 1e-5, "{e1} {e2} {alpha}");
        }
    }

    fn random_pairs() -> Vec<(Lobe, Lobe, f64)> {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        (0..400)
            .map(|_| {
                let alpha = random.random_range(0.0..PI);
                let exponents: [f64; 2] = std::array::from_fn(|_| 10f64.powf(random.random_range(-2.0..4.0)));
                let (a, b) = lobes(exponents[0], exponents[1], alpha);
                (a, b, alpha)
            })
            .collect()
    }

    #[test]
    fn bound_is_never_exceeded_and_is_sharp_for_equal_axes() {
        for (a, b, alpha) in random_pairs() {
            let (bound, integral) = (product_bound(&a, &b), product_integral(&a, &b));
            assert!(integral <= bound * (1.0 + 1e-9), "{a:?} {b:?} {alpha}: {integral} {bound}");
            let same = Lobe { axis: a.axis, ..b };
            assert!((product_bound(&a, &same) / product_integral(&a, &same) - 1.0).abs() < 1e-8);
            // Pointwise too.
            let peak = Saddle::new(a.exponent, b.exponent, HalfAngle::between(a.axis, b.axis));
            let axis = peak.direction(a.axis, b.axis);
            let top = peak.ln_value(a.exponent, b.exponent).exp();
            let cover = Lobe { axis, exponent: a.exponent + b.exponent, scale: top * (1.0 + 1e-9) };
            for v in [a.axis, b.axis, [0.0, 0.8, 0.6], [0.1, 0.7, 0.707], [0.6, -0.48, 0.64]] {
                let v = unit(v);
                assert!(a.value(v) * b.value(v) <= cover.value(v) + 1e-12);
            }
        }
    }

    /// The constants that the module's documentation states.
    #[test]
    fn estimate_is_within_its_stated_error() {
        let (mut low, mut high, mut low_from_one, mut high_from_one) = (1.0f64, 1.0f64, 1.0f64, 1.0f64);
        for e1 in [0.0, 0.1, 0.3, 1.0, 2.0, 10.0, 100.0, 1e5] {
            for e2 in [0.0, 0.1, 0.3, 1.0, 2.0, 10.0, 100.0, 1e5] {
                for step in 0..200 {
                    let pair = Pair::new(e1, e2, HalfAngle::from_angle(PI * f64::from(step) / 200.0));
                    if !pair.n().is_finite() || pair.plane.ln_value == f64::NEG_INFINITY {
                        continue;
                    }
                    let ratio = pair.relative_integral() / pair.estimate();
                    (low, high) = (low.min(ratio), high.max(ratio));
                    if f64::min(e1, e2) >= 1.0 {
                        (low_from_one, high_from_one) = (low_from_one.min(ratio), high_from_one.max(ratio));
                    }
                }
            }
        }
        assert!(low > 0.855 && high < 1.04, "{low} {high}");
        assert!(low_from_one > 0.97 && high_from_one < 1.02, "{low_from_one} {high_from_one}");
    }

    #[test]
    fn rules_keep_what_they_promise() {
        for (a, b, _) in random_pairs() {
            let integral = product_integral(&a, &b);
            if integral < 1e-250 {
                // Too near to underflow to keep its digits.
                continue;
            }
            let [published, preserving, moments] = ProductRule::ALL.map(|rule| product(&a, &b, rule));
            for lobe in [preserving, moments] {
                assert!((lobe.integral() - integral).abs() <= 1e-9 * integral, "{a:?} {b:?}");
            }
            assert_eq!((published.axis, published.exponent), (preserving.axis, preserving.exponent));
            // Mean vectors by integrals with one more factor of either cosine.
            for (axis, more) in [(a.axis, (1.0, 0.0)), (b.axis, (0.0, 1.0))] {
                let (first, second) =
                    (Lobe { exponent: a.exponent + more.0, ..a }, Lobe { exponent: b.exponent + more.1, ..b });
                let mean = (moments.exponent + 1.0) / (moments.exponent + 2.0) * moments.integral();
                let expected = product_integral(&first, &second);
                let found = mean * dot(&moments.axis, &axis);
                assert!((found - expected).abs() <= 1e-7 * integral, "{a:?} {b:?}: {found} {expected}");
            }
            for lobe in [published, moments] {
                assert!((dot(&lobe.axis, &lobe.axis) - 1.0).abs() < 1e-12);
                assert!(lobe.exponent >= 0.0 && lobe.scale >= 0.0);
            }
            // Symmetric.
            let exchanged = product(&b, &a, ProductRule::Published);
            assert!((exchanged.exponent / published.exponent - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn extremes_are_finite() {
        let axes = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0; 3], [f64::NAN; 3], [0.0, 0.0, 1e-200]];
        for first in axes {
            for second in axes {
                for e1 in [0.0, 1.0, 1e5, 1e7, f64::INFINITY, f64::NAN, -3.0] {
                    for e2 in [0.0, 1e5, f64::INFINITY] {
                        let a = Lobe { axis: first, exponent: e1, scale: 2.0 };
                        let b = Lobe { axis: second, exponent: e2, scale: 0.5 };
                        assert!(product_integral(&a, &b).is_finite() && product_bound(&a, &b).is_finite());
                        for rule in ProductRule::ALL {
                            let lobe = product(&a, &b, rule);
                            assert!(lobe.exponent.is_finite() && lobe.scale.is_finite(), "{a:?} {b:?} {lobe:?}");
                            assert!(lobe.axis.iter().all(|x| x.is_finite()) && lobe.integral().is_finite());
                        }
                        let none = Lobe { scale: 0.0, ..a };
                        assert_eq!(product(&none, &b, ProductRule::Moments).scale, 0.0);
                    }
                }
            }
        }
    }
}
