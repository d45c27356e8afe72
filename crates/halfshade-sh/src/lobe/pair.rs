//! The geometry of two lobes' axes: how far apart they are, and where between them the product is largest.

/// The angle α between two axes by its half: `p = cos²(α/2)`, `q = sin²(α/2)`, p + q = 1.
///
/// Unlike cos α these two keep their relative accuracy where lobes are narrow, α near 0, and where they barely meet,
/// α near π.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfAngle {
    pub(super) p: f64,
    pub(super) q: f64,
}

impl HalfAngle {
    /// Between two axes. Lengths other than 1 are divided out; axes without a direction give some angle.
    pub(super) fn between(a: [f64; 3], b: [f64; 3]) -> Self {
        let (a, b) = (unit(a), unit(b));
        let squared = |sign: f64| (0..3).map(|axis| (a[axis] + sign * b[axis]).powi(2)).sum::<f64>();
        let (p, q) = (squared(1.0), squared(-1.0));
        let sum = p + q;
        if sum > 0.0 && sum.is_finite() { Self { p: p / sum, q: q / sum } } else { Self { p: 1.0, q: 0.0 } }
    }

    /// For an angle in radians, clamped to [0, π].
    #[cfg(test)]
    pub(super) fn from_angle(angle: f64) -> Self {
        // cos by the sine of the complement: exactly 0 at π.
        let half = 0.5 * angle.clamp(0.0, std::f64::consts::PI);
        Self { p: (std::f64::consts::FRAC_PI_2 - half).sin().powi(2), q: half.sin().powi(2) }
    }

    pub(super) fn sine(self) -> f64 {
        2.0 * (self.p * self.q).sqrt()
    }
}

/// `v` over its length, which may be tiny or huge; 0 where it has no direction.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) || v.iter().any(|x| x.is_nan()) {
        return [0.0; 3];
    }
    let v = v.map(|x| x / largest);
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

/// Exponents below this count as this: where both vanish the product is constant and has no peak, the middle is taken.
const SMALLEST: f64 = 1e-12;

/// Where `cos(x)^e1 · cos(α-x)^e2` is largest, x being the angle from the first axis toward the second.
///
/// `e1 tan x = e2 tan(α-x)`, or with `k = (e2-e1)/(e2+e1)`: `sin(2x-α) = k sin α`. In products of sines and cosines, `D
/// = cos(2x-α) = sqrt(1 - k² sin²α)`, `2 cos x cos(α-x) = D + cos α`, `2 sin x sin(α-x) = D - cos α`, and the product
/// of the last two is `(1-k²) sin²α`: from which either is had without cancellation, for every α from 0 to π.
#[derive(Debug, Clone, Copy)]
pub(super) struct Saddle {
    /// `1 - k` and `1 + k`.
    pub(super) first: f64,
    pub(super) second: f64,
    sine: f64,
    /// `2 cos x cos(α-x)` and `2 sin x sin(α-x)`.
    cosines: f64,
    sines: f64,
}

impl Saddle {
    pub(super) fn new(e1: f64, e2: f64, angle: HalfAngle) -> Self {
        let (e1, e2) = (e1.max(SMALLEST), e2.max(SMALLEST));
        let (first, second) = (2.0 * e1 / (e1 + e2), 2.0 * e2 / (e1 + e2));
        let (k, sine, cosine) = (0.5 * (second - first), angle.sine(), angle.p - angle.q);
        let product = first * second * sine * sine;
        // 1 - k² sin²α as a sum of what is not negative: (1-k²) sin²α + cos²α, (1-k²) being first·second.
        let d = cosine.mul_add(cosine, product).sqrt();
        debug_assert!((d * d - (1.0 - k * k * sine * sine)).abs() < 1e-9);
        let large = (d + cosine.abs()).max(f64::MIN_POSITIVE);
        let (cosines, sines) = if cosine >= 0.0 { (large, product / large) } else { (product / large, large) };
        Self { first, second, sine, cosines, sines }
    }

    /// `1/(1 + tan x tan(α-x))`, [0, 1]: 1 for equal axes, 0 for opposite ones, 1/2 for axes at right angles.
    ///
    /// In the plane of the axes the logarithm of the product curves at the saddle by `(e1+e2)/g`, across it by `e1+e2`:
    /// so g is the squared ratio of the widths.
    pub(super) fn g(&self) -> f64 {
        self.cosines / (self.cosines + self.sines)
    }

    /// `(1/2 π - x, 1/2 π - (α-x))`: how far the saddle is from where each lobe ends, in the plane of the axes, radians.
    pub(super) fn to_edges(self) -> (f64, f64) {
        (self.cosines.atan2(self.second * self.sine), self.cosines.atan2(self.first * self.sine))
    }

    /// `ln(cos(x)^e1 cos(α-x)^e2)` for these exponents, which need not be the ones whose saddle this is. -∞ for opposite
    /// axes.
    pub(super) fn ln_value(&self, e1: f64, e2: f64) -> f64 {
        let ln_cos = |exponent: f64, tangent: f64| match exponent {
            0.0 => 0.0,
            _ => -0.5 * exponent * (tangent * tangent).ln_1p(),
        };
        let scale = self.sine / self.cosines;
        if self.cosines <= 0.0 || !scale.is_finite() {
            return if e1 + e2 > 0.0 { f64::NEG_INFINITY } else { 0.0 };
        }
        ln_cos(e1, self.second * scale) + ln_cos(e2, self.first * scale)
    }

    /// Weights of the two axes whose weighted sum points at the saddle, up to a common factor.
    pub(super) fn weights(&self) -> (f64, f64) {
        let weight = |share: f64| share / self.cosines.hypot(share * self.sine).max(f64::MIN_POSITIVE);
        (weight(self.first), weight(self.second))
    }

    /// The direction of the saddle between two unit axes; the first axis if they are opposite.
    pub(super) fn direction(&self, a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        let (wa, wb) = self.weights();
        let sum = unit(std::array::from_fn(|axis| wa * a[axis] + wb * b[axis]));
        if sum == [0.0; 3] { a } else { sum }
    }
}

/// The angle whose saddle for these exponents has this g: the inverse of [`Saddle::g`].
///
/// With `r = 2g - 1`: `cos²α = r² (1-k²)/(1 - r²k²)`, `sin²α = (1-r²)/(1 - r²k²)`.
pub(super) fn angle_of_g(e1: f64, e2: f64, g: f64) -> HalfAngle {
    let (e1, e2) = (e1.max(SMALLEST), e2.max(SMALLEST));
    let r = 2.0 * g - 1.0;
    let one_less_k_squared = 4.0 * e1 * e2 / ((e1 + e2) * (e1 + e2));
    let one_less_r_squared = 4.0 * g * (1.0 - g);
    let below = one_less_r_squared + r * r * one_less_k_squared;
    let cosine = r.abs() * (one_less_k_squared / below).sqrt();
    let sine_squared = one_less_r_squared / below;
    let (near, far) = (0.5 * (1.0 + cosine), 0.5 * sine_squared / (1.0 + cosine));
    if r >= 0.0 { HalfAngle { p: near, q: far } } else { HalfAngle { p: far, q: near } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const EXPONENTS: [f64; 7] = [0.0, 0.01, 0.7, 1.0, 12.0, 3000.0, 1e5];
    const ANGLES: [f64; 8] = [1e-6, 0.01, 0.5, 1.57, 1.6, 2.5, 3.0, 3.13];

    /// The saddle is where `e1 tan x = e2 tan(α-x)`, and nothing beside it is larger.
    #[test]
    fn saddle_is_the_maximum() {
        for e1 in EXPONENTS {
            for e2 in EXPONENTS {
                for alpha in ANGLES {
                    let saddle = Saddle::new(e1, e2, HalfAngle::from_angle(alpha));
                    let (z, y) = saddle.to_edges();
                    assert!((z + y - (PI - alpha)).abs() < 1e-9, "{e1} {e2} {alpha}");
                    let ln = |z: f64, y: f64| e1 * z.sin().ln() + e2 * y.sin().ln();
                    assert!((saddle.ln_value(e1, e2) - ln(z, y)).abs() < 1e-9 * (1.0 + ln(z, y).abs()));
                    for step in [-1e-3, 1e-3] {
                        if z + step > 0.0 && y - step > 0.0 {
                            assert!(ln(z + step, y - step) <= ln(z, y) + 1e-9, "{e1} {e2} {alpha}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn g_and_angle_are_inverse() {
        for e1 in EXPONENTS {
            for e2 in EXPONENTS {
                let (e1, e2) = (e1 + 1.0, e2 + 1.0);
                for g in [1e-6, 0.1, 0.5, 0.7, 0.999, 1.0] {
                    let angle = angle_of_g(e1, e2, g);
                    assert!((angle.p + angle.q - 1.0).abs() < 1e-12);
                    assert!((Saddle::new(e1, e2, angle).g() - g).abs() < 1e-9, "{e1} {e2} {g}");
                }
            }
        }
    }

    #[test]
    fn directions_lie_between_the_axes() {
        for alpha in ANGLES {
            let (a, b) = ([0.0, 0.0, 1.0], [alpha.sin(), 0.0, alpha.cos()]);
            for e1 in EXPONENTS {
                for e2 in EXPONENTS {
                    let saddle = Saddle::new(e1, e2, HalfAngle::between(a, b));
                    let direction = saddle.direction(a, b);
                    let x = direction[0].atan2(direction[2]);
                    assert!((x + saddle.to_edges().0 - 0.5 * PI).abs() < 1e-6, "{e1} {e2} {alpha}");
                }
            }
        }
        let up = [0.0, 0.0, 1.0];
        for (a, b) in [(up, up), (up, [0.0, 0.0, -1.0]), (up, [0.0; 3]), ([f64::NAN; 3], up), (up, [1e-300, 0.0, 0.0])]
        {
            let angle = HalfAngle::between(a, b);
            assert!(angle.p >= 0.0 && angle.q >= 0.0 && (angle.p + angle.q - 1.0).abs() < 1e-12);
        }
        assert_eq!(Saddle::new(3.0, 4.0, HalfAngle::from_angle(PI)).ln_value(3.0, 4.0), f64::NEG_INFINITY);
    }
}
