//! The lobe that is closest to a product of two, in the least squares of [Meunier2009, eq. 19].
//!
//! The paper runs Levenberg-Marquardt on exponent and scale together. Here the scale is eliminated: for a given
//! exponent e the best scale is `∫ f c / ∫ c²` with `c = max(a·v,0)^e`, `∫ c² = 2π/(2e+1)`, and what is left to
//! maximize is `(∫ f c)² (2e+1)`. Its logarithmic derivative is `mean of ln cos δ + mean of ln cos(ψ-x) + 1/(2e+1) =
//! 0`, both means under the weight f c: one equation in one unknown, whose means are closed form across the plane of
//! the axes and a sum over the points of [`Plane`] in it. The minimum is the same; there is no start value and no
//! tolerance to choose.

use super::plane::{Plane, ln_wallis, mean_ln_cos};
use std::f64::consts::TAU;

/// Exponent and scale of a fit; the scale is in units of the product's value at the plane's saddle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    pub(super) exponent: f64,
    pub(super) scale: f64,
}

/// Least squares over the sphere of `scale·max(a·v,0)^exponent` to the product with exponents `e1`, `e2` of which
/// `plane` is the section; the axis is at `axis` radians from where the second lobe ends. Exponents are at least 0.
/// Relative error 1e-9 of the exponent plus 1.
pub(super) fn least_squares(e1: f64, e2: f64, plane: &Plane, axis: f64) -> Fit {
    let ln_cos: Vec<f64> =
        plane.longitudes.iter().map(|longitude| (longitude - axis).cos().max(f64::MIN_POSITIVE).ln()).collect();
    // Sum and mean of ln cos(ψ-x), scaled by the largest factor so that no exponent underflows everything.
    let largest = ln_cos.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
    let moments = |e: f64| {
        let (mut sum, mut first) = (0.0, 0.0);
        for (mass, ln) in plane.masses.iter().zip(&ln_cos) {
            let weight = mass * (e * (ln - largest)).exp();
            sum += weight;
            first += weight * ln;
        }
        (sum, first / sum)
    };
    let slope = |e: f64| mean_ln_cos(e1 + e2 + e + 1.0) + moments(e).1 + 1.0 / (2.0 * e + 1.0);
    let exponent = if slope(0.0).is_nan() || slope(0.0) <= 0.0 { 0.0 } else { root(slope, e1 + e2) };
    let integral = moments(exponent).0 * (exponent * largest + ln_wallis(e1 + e2 + exponent + 1.0)).exp();
    Fit { exponent, scale: integral * (2.0 * exponent + 1.0) / TAU }
}

/// Where `slope` falls through 0, given that it is positive at 0: false position (its Illinois variant) in ln(e+1), on
/// the slope times e+1, which is then neither steep nor flat.
fn root(slope: impl Fn(f64) -> f64, guess: f64) -> f64 {
    let at = |ln: f64| (ln, slope(ln.exp_m1()) * ln.exp());
    let (mut low, mut high) = (at(0.0), at((2.0 * guess + 3.0).ln()));
    while high.1 > 0.0 && high.0 < 40.0 {
        (low, high) = (high, at(high.0 + 1.0));
    }
    // An end that stays twice counts half, so that the other can't creep.
    let (mut low_value, mut high_value, mut last) = (low.1, high.1, None);
    for _ in 0..80 {
        let middle = at((low.0 * high_value - high.0 * low_value) / (high_value - low_value));
        let above = middle.1 > 0.0;
        let stays_again = last.replace(above) == Some(above);
        let step = if above {
            high_value *= if stays_again { 0.5 } else { 1.0 };
            low_value = middle.1;
            middle.0 - std::mem::replace(&mut low, middle).0
        } else {
            low_value *= if stays_again { 0.5 } else { 1.0 };
            high_value = middle.1;
            std::mem::replace(&mut high, middle).0 - middle.0
        };
        if middle.1 == 0.0 || step.abs() < 1e-11 || !middle.0.is_finite() {
            return middle.0.exp_m1();
        }
    }
    (0.5 * (low.0 + high.0)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::super::pair::{HalfAngle, Saddle};
    use super::*;
    use crate::quadrature::SphereQuadrature;

    fn fit(e1: f64, e2: f64, alpha: f64) -> (Fit, f64) {
        let saddle = Saddle::new(e1 + 1.0, e2 + 1.0, HalfAngle::from_angle(alpha));
        let plane = Plane::new(e1, e2, &saddle);
        let axis = Saddle::new(e1, e2, HalfAngle::from_angle(alpha)).to_edges().1;
        let mut fit = least_squares(e1, e2, &plane, axis);
        fit.scale *= plane.ln_value.exp();
        (fit, axis)
    }

    #[test]
    fn equal_axes_add_exponents() {
        for (e1, e2) in [(0.0, 0.0), (0.2, 0.1), (1.0, 0.0), (3.0, 8.0), (1e5, 1e5)] {
            let (fit, _) = fit(e1, e2, 0.0);
            assert!((fit.exponent / (e1 + e2) - 1.0).abs() < 1e-7 || fit.exponent < 1e-7, "{e1} {e2} {fit:?}");
            assert!((fit.scale - 1.0).abs() < 1e-7, "{e1} {e2} {fit:?}");
        }
    }

    /// Against quadrature over the whole sphere, which knows nothing of planes and saddles: no other exponent or scale
    /// nearby has a smaller squared distance.
    #[test]
    fn nothing_nearby_is_closer() {
        let rule = SphereQuadrature::exact_to(300);
        for (e1, e2, alpha) in [(1.0, 1.0, 1.2), (2.0, 9.0, 0.4), (0.8, 3.0, 2.0), (1.0, 20.0, 1.5)] {
            let (fit, axis) = fit(e1, e2, alpha);
            let a = [0.0, 0.0, 1.0];
            let b = [f64::sin(alpha), 0.0, f64::cos(alpha)];
            // Longitude from where b ends, α - π/2 in the angle from a.
            let x = alpha - 0.5 * std::f64::consts::PI + axis;
            let c = [x.sin(), 0.0, x.cos()];
            let lobe = |d: [f64; 3], v: [f64; 3], e: f64| crate::basis::dot(&d, &v).max(0.0).powf(e);
            let distance = |exponent: f64, scale: f64| {
                rule.integrate(|v| (lobe(a, v, e1) * lobe(b, v, e2) - scale * lobe(c, v, exponent)).powi(2))
            };
            let best = distance(fit.exponent, fit.scale);
            for (de, ds) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02), (0.02, 0.02), (-0.02, -0.02)] {
                let other = distance(fit.exponent * (1.0 + de), fit.scale * (1.0 + ds));
                assert!(other > best, "{e1} {e2} {alpha}: {best} {other}");
            }
        }
    }
}
