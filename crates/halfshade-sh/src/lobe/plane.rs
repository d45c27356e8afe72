//! Integrals of products of lobes, reduced to one dimension.
//!
//! With δ the latitude above the plane of two axes and ψ the longitude in it, both dot products carry the factor cos δ,
//! and `∫ max(a·v,0)^e1 max(b·v,0)^e2 dω = ∫ cos^(e1+e2+1) δ dδ · ∫ cos^e1 ψ cos^e2(α-ψ) dψ`. The first factor is
//! [`ln_wallis`], the second is what [`Plane`] integrates. A third lobe whose axis is in the plane changes nothing of
//! this.

use super::pair::Saddle;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Natural logarithm of `∫ cos^m δ dδ` from -π/2 to π/2, `sqrt(π) Γ((m+1)/2)/Γ(m/2+1)`, for m ≥ 0. Relative error 1e-11.
pub(super) fn ln_wallis(m: f64) -> f64 {
    let (mut m, mut ln) = (m, 0.0);
    while m < 19.0 {
        ln += ((m + 2.0) / (m + 1.0)).ln();
        m += 2.0;
    }
    let h = 0.5 * (m + 1.0);
    let i = 1.0 / (h * h);
    let series = (-1.0 / 8.0 + i * (1.0 / 192.0 + i * (-1.0 / 640.0 + i * (17.0 / 14336.0)))) / h;
    ln + 0.5 * (PI / h).ln() - series
}

/// Derivative of [`ln_wallis`]: the mean of ln cos δ under the weight cos^m δ.
pub(super) fn mean_ln_cos(m: f64) -> f64 {
    let (mut m, mut sum) = (m, 0.0);
    while m < 19.0 {
        sum += 1.0 / (m + 2.0) - 1.0 / (m + 1.0);
        m += 2.0;
    }
    let h = 0.5 * (m + 1.0);
    let i = 1.0 / (h * h);
    let series = 0.5 / h + i * (1.0 / 8.0 + i * (-1.0 / 64.0 + i * (1.0 / 128.0 - i * (17.0 / 2048.0))));
    sum - 0.5 * series
}

/// A point of a quadrature rule on (0, 1): u, which keeps its relative accuracy near 0, and the weight.
type Node = (f64, f64);

/// Tanh-sinh quadrature on (0, 1), `u = 1/(1 + exp(-π sinh t))`: singular derivatives at the ends, as of x^0.1, don't
/// hurt.
fn rule() -> &'static [Node] {
    static RULE: OnceLock<Vec<Node>> = OnceLock::new();
    RULE.get_or_init(|| {
        let (step, count) = (1.0 / 12.0, 39);
        let node = |i: i32| {
            let t = step * f64::from(i);
            let (small, large) = ((-PI * t.sinh()).exp(), (PI * t.sinh()).exp());
            let (u, rest) = (1.0 / (1.0 + small), 1.0 / (1.0 + large));
            (u, step * PI * t.cosh() * u * rest)
        };
        (-count..=count).map(node).collect()
    })
}

/// Integration ends where the product has fallen to e to the minus this.
const NEGLIGIBLE: f64 = 42.0;

/// `cos^e1 ψ cos^e2(α-ψ)` in the plane of the axes at quadrature points, over its value at a saddle.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    /// Longitude from where the second lobe ends, in (0, π-α).
    pub(super) longitudes: Vec<f64>,
    /// Weight times the product's value.
    pub(super) masses: Vec<f64>,
    /// Logarithm of the value at the saddle.
    pub(super) ln_value: f64,
}

impl Plane {
    /// For the exponents, with the saddle of the exponents plus 1 (see [`balanced`](super::product)) as the middle.
    ///
    /// Both halves end where the product has become negligible, found by ever longer steps: the product is log-concave.
    pub(super) fn new(e1: f64, e2: f64, saddle: &Saddle) -> Self {
        let (z, y) = saddle.to_edges();
        let ln = |z: f64, y: f64| {
            let ln_sin = |exponent: f64, angle: f64| if exponent == 0.0 { 0.0 } else { exponent * angle.sin().ln() };
            ln_sin(e1, z) + ln_sin(e2, y)
        };
        let ln_value = ln(z, y);
        let rule = rule();
        let mut plane = Self {
            longitudes: Vec::with_capacity(2 * rule.len()),
            masses: Vec::with_capacity(2 * rule.len()),
            ln_value,
        };
        if !ln_value.is_finite() {
            return plane;
        }
        let width = (saddle.g() / (e1 + e2 + 2.0)).sqrt();
        let reach = |limit: f64, ln_at: &dyn Fn(f64) -> f64| {
            let mut step = width;
            while step < limit && ln_value - ln_at(step) < NEGLIGIBLE {
                step *= 1.5;
            }
            step.min(limit)
        };
        let below = reach(y, &|step| ln(z + step, y - step));
        let above = reach(z, &|step| ln(z - step, y + step));
        for &(u, weight) in rule {
            let from_edge = (y - below) + below * u;
            let to_edge = z + (y - from_edge);
            plane.push(from_edge, weight * below * (ln(to_edge, from_edge) - ln_value).exp());
            let to_edge = (z - above) + above * u;
            let from_edge = y + (z - to_edge);
            plane.push(from_edge, weight * above * (ln(to_edge, from_edge) - ln_value).exp());
        }
        plane
    }

    fn push(&mut self, longitude: f64, mass: f64) {
        self.longitudes.push(longitude);
        self.masses.push(mass);
    }

    /// `∫ cos^e1 ψ cos^e2(α-ψ) dψ` over the value at the saddle.
    pub(super) fn total(&self) -> f64 {
        self.masses.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::pair::HalfAngle;
    use super::*;

    #[test]
    fn wallis_integrals_obey_their_closed_forms() {
        let known = [(0.0, PI), (1.0, 2.0), (2.0, PI / 2.0), (3.0, 4.0 / 3.0), (4.0, 3.0 * PI / 8.0)];
        for (m, value) in known {
            assert!((ln_wallis(m).exp() / value - 1.0).abs() < 1e-11, "{m}");
        }
        // W(m) W(m+1) = 2π/(m+1).
        for m in [0.3, 7.7, 18.9, 19.0, 55.5, 1e3, 1e5, 1e7] {
            let product = (ln_wallis(m) + ln_wallis(m + 1.0)).exp();
            assert!((product * (m + 1.0) / (2.0 * PI) - 1.0).abs() < 1e-11, "{m}");
            let step = 1e-4 * (1.0 + m);
            let difference = (ln_wallis(m + step) - ln_wallis(m - step)) / (2.0 * step);
            assert!((difference / mean_ln_cos(m) - 1.0).abs() < 1e-6 || m < step, "{m}");
        }
        assert!((mean_ln_cos(0.0) + 2f64.ln()).abs() < 1e-11);
    }

    /// Equal axes leave a power of the cosine, exponents that differ by one a power of cos(α/2), exponents 0 the lune.
    #[test]
    fn integrals_in_the_plane_obey_their_closed_forms() {
        let value = |e1: f64, e2: f64, alpha: f64| {
            let plane = Plane::new(e1, e2, &Saddle::new(e1 + 1.0, e2 + 1.0, HalfAngle::from_angle(alpha)));
            plane.total() * plane.ln_value.exp()
        };
        for (e1, e2) in
            [(0.0, 0.0), (0.1, 0.0), (0.3, 0.4), (1.0, 1.0), (7.0, 0.2), (500.0, 3.0), (1e5, 1e5), (1e5, 0.0)]
        {
            let ratio = value(e1, e2, 0.0) / ln_wallis(e1 + e2).exp();
            assert!((ratio - 1.0).abs() < 1e-9, "{e1} {e2}: {ratio}");
        }
        for alpha in [1e-3, 0.5, 1.57, 3.0, 3.1] {
            assert!((value(0.0, 0.0, alpha) / (PI - alpha) - 1.0).abs() < 1e-9);
            for e in [0.0, 0.05, 0.6, 3.0, 40.0] {
                // 2^(2e+2) cos^(2e+2)(α/2) B(e+1, e+2), B from the same integral at α = 0.
                let expected = ln_wallis(2.0 * e + 1.0).exp() * f64::cos(0.5 * alpha).powf(2.0 * e + 2.0);
                let ratio = value(e, e + 1.0, alpha) / expected;
                assert!((ratio - 1.0).abs() < 1e-8, "{e} {alpha}: {ratio}");
            }
        }
    }
}
