//! Eight products of lobes at a time in f32.

use super::table::LobeTable;
use super::{Lobe, MAX_EXPONENT, ProductRule};
use std::f32::consts::TAU;
use wide::f32x8;

/// Eight lobes side by side. A scale of 0 is a lane without a lobe.
#[derive(Debug, Clone, Copy)]
pub struct Lobe8 {
    /// Unit axes.
    pub axis: [f32x8; 3],
    /// Exponents, clamped to [0, [`MAX_EXPONENT`]].
    pub exponent: f32x8,
    /// Values on the axes.
    pub scale: f32x8,
}

impl Lobe8 {
    /// The same lobe in every lane.
    pub fn splat(lobe: &Lobe) -> Self {
        let splat = |x: f64| f32x8::splat(x as f32);
        Self { axis: lobe.axis.map(splat), exponent: splat(lobe.exponent), scale: splat(lobe.scale) }
    }

    /// The lobe of one lane, `lane` taken modulo 8.
    pub fn lane(&self, lane: usize) -> Lobe {
        let get = |x: f32x8| f64::from(x.to_array()[lane % 8]);
        Lobe { axis: self.axis.map(get), exponent: get(self.exponent), scale: get(self.scale) }
    }

    /// `∫ c dω = 2π s/(e+1)`: see [`Lobe::integral`].
    #[inline(always)]
    pub fn integral(&self) -> f32x8 {
        self.scale * f32x8::splat(TAU) / (f32x8::ONE + clamped(self.exponent))
    }

    /// Bound that `|∫ a b dω|` never exceeds but by rounding: see [`product_bound`](super::product_bound).
    ///
    /// Cheaper than a product, and without a table: lanes below the threshold of [Meunier2009, 4.3] need no product.
    #[inline(always)]
    pub fn product_bound(&self, other: &Self) -> f32x8 {
        let (e1, e2) = (clamped(self.exponent), clamped(other.exponent));
        let peak = Saddle8::new(e1.max(SMALLEST), e2.max(SMALLEST), Angle8::between(&self.axis, &other.axis));
        (self.scale * other.scale).abs() * peak.value(e1, e2) * f32x8::splat(TAU) / (e1 + e2 + f32x8::ONE)
    }
}

impl LobeTable {
    /// `a·b` as lobes: the twin of [`product`](super::product), with the errors of `table.rs`.
    ///
    /// The product of opposite axes is rounding only, and below 1e-34 of the scales it is 0. Axes that are not of unit
    /// length, or not finite, give some answer and no panic.
    #[inline(always)]
    pub fn product8(&self, a: &Lobe8, b: &Lobe8) -> Lobe8 {
        let product = Product8::new(a, b);
        let ratios = self.ratios(product.e1, product.e2, product.width);
        let shift = match self.rule() {
            ProductRule::Moments => ratios.third,
            ProductRule::Published | ProductRule::IntegralPreserving => f32x8::ZERO,
        };
        let shifted = |exponent: f32x8| (exponent + shift).fast_max(SMALLEST);
        let axis = Saddle8::new(shifted(product.e1), shifted(product.e2), product.angle).direction(&a.axis, &b.axis);
        // sqrt(g) = 1/sqrt(1 + width²).
        let root = f32x8::ONE / product.width.mul_add(product.width, f32x8::ONE).sqrt();
        let n = match self.rule() {
            ProductRule::Moments => product.n * (root + root) / root.mul_add(root, f32x8::ONE),
            ProductRule::Published | ProductRule::IntegralPreserving => product.n,
        };
        let exponent = ratios.exponent.mul_add(n, -f32x8::ONE).fast_max(f32x8::ZERO).fast_min(LARGEST);
        let scale = match self.rule() {
            ProductRule::Published => ratios.third * f32x8::splat(2.0) * root.sqrt() / (f32x8::ONE + root),
            ProductRule::IntegralPreserving | ProductRule::Moments => {
                ratios.integral * product.correction * ((exponent + f32x8::ONE) / product.n)
            }
        };
        Lobe8 { axis, exponent, scale: scale * product.value }
    }

    /// `∫ a b dω`, for the last product of a chain, which needs no lobe: the twin of
    /// [`product_integral`](super::product_integral).
    #[inline(always)]
    pub fn product_integral8(&self, a: &Lobe8, b: &Lobe8) -> f32x8 {
        let product = Product8::new(a, b);
        let ratios = self.ratios(product.e1, product.e2, product.width);
        ratios.integral * product.correction * product.value * (f32x8::splat(TAU) / product.n)
    }
}

const LARGEST: f32x8 = f32x8::splat(MAX_EXPONENT as f32);

/// Exponents of a peak count as at least this, as in f64.
const SMALLEST: f32x8 = f32x8::splat(1e-6);

/// Stand-in for 0 where one divides.
const TINY: f32x8 = f32x8::splat(1e-20);

#[inline(always)]
fn clamped(exponent: f32x8) -> f32x8 {
    exponent.max(f32x8::ZERO).fast_min(LARGEST)
}

/// Sine and cosine of the angle between two axes, the sine accurate near 0 and π.
#[derive(Clone, Copy)]
struct Angle8 {
    sine: f32x8,
    cosine: f32x8,
}

impl Angle8 {
    #[inline(always)]
    fn between(a: &[f32x8; 3], b: &[f32x8; 3]) -> Self {
        // A quarter of a square, at most 1 and never NaN whatever the axes.
        let quarter =
            |[x, y, z]: [f32x8; 3]| (x.mul_add(x, y.mul_add(y, z * z)) * f32x8::splat(0.25)).fast_min(f32x8::ONE);
        let p = quarter(std::array::from_fn(|axis| a[axis] + b[axis]));
        let q = quarter(std::array::from_fn(|axis| a[axis] - b[axis]));
        Self { sine: (p * q).sqrt() * f32x8::splat(2.0), cosine: p - q }
    }
}

/// The twin of `Saddle` in `pair.rs`.
#[derive(Clone, Copy)]
struct Saddle8 {
    first: f32x8,
    second: f32x8,
    sine: f32x8,
    cosines: f32x8,
    sines: f32x8,
    /// Inverse of the cosines.
    inverse: f32x8,
}

impl Saddle8 {
    /// Exponents must be positive.
    #[inline(always)]
    fn new(e1: f32x8, e2: f32x8, Angle8 { sine, cosine }: Angle8) -> Self {
        let twice = f32x8::splat(2.0) / (e1 + e2);
        let (first, second) = (e1 * twice, e2 * twice);
        let product = first * second * sine * sine;
        let large = cosine.mul_add(cosine, product).sqrt() + cosine.abs();
        let small = product / large.fast_max(TINY);
        let acute = cosine.simd_ge(f32x8::ZERO);
        let cosines = acute.select(large, small).fast_max(TINY);
        Self { first, second, sine, cosines, sines: acute.select(small, large), inverse: f32x8::ONE / cosines }
    }

    /// `cos(x)^e1 cos(α-x)^e2` there; 0 where it is below 1e-34, so that nothing becomes subnormal.
    #[inline(always)]
    fn value(&self, e1: f32x8, e2: f32x8) -> f32x8 {
        let scale = self.sine * self.inverse;
        let (t1, t2) = (self.second * scale, self.first * scale);
        // Tangents beyond this would overflow when squared.
        let ln_1p_squared = |t: f32x8| {
            let t = t.fast_min(f32x8::splat(1e18));
            (t * t).ln_1p()
        };
        let ln = (e1 * ln_1p_squared(t1) + e2 * ln_1p_squared(t2)) * f32x8::splat(-0.5);
        ln.simd_gt(f32x8::splat(-78.0)).select(ln.fast_max(f32x8::splat(-78.0)).exp(), f32x8::ZERO)
    }

    #[inline(always)]
    fn direction(&self, a: &[f32x8; 3], b: &[f32x8; 3]) -> [f32x8; 3] {
        // Each weight as in f64, times the product of both denominators.
        let denominator = |share: f32x8| {
            let across = share * self.sine;
            across.mul_add(across, self.cosines * self.cosines).sqrt()
        };
        let (wa, wb) = (self.first * denominator(self.second), self.second * denominator(self.first));
        let sum: [f32x8; 3] = std::array::from_fn(|axis| wa.mul_add(a[axis], wb * b[axis]));
        let squared = sum[0].mul_add(sum[0], sum[1].mul_add(sum[1], sum[2] * sum[2]));
        // Opposite axes leave nothing.
        let least = f32x8::splat(1e-36);
        let defined = squared.simd_gt(least);
        let inverse = f32x8::ONE / squared.fast_max(least).sqrt();
        std::array::from_fn(|axis| defined.select(sum[axis] * inverse, a[axis]))
    }
}

/// The closed forms of a pair, at its balanced point.
struct Product8 {
    e1: f32x8,
    e2: f32x8,
    angle: Angle8,
    /// `sqrt(1/g - 1)`.
    width: f32x8,
    n: f32x8,
    /// c.
    correction: f32x8,
    /// Both scales times the value there.
    value: f32x8,
}

impl Product8 {
    #[inline(always)]
    fn new(a: &Lobe8, b: &Lobe8) -> Self {
        let (e1, e2) = (clamped(a.exponent), clamped(b.exponent));
        let angle = Angle8::between(&a.axis, &b.axis);
        let (f1, f2) = (e1 + f32x8::ONE, e2 + f32x8::ONE);
        let balanced = Saddle8::new(f1, f2, angle);
        let ratio = balanced.sines * balanced.inverse;
        let sum = f1 + f2;
        // (E+2)/g - 1 as (E+1) + (E+2)(1/g - 1).
        let in_plane = sum.mul_add(ratio, sum - f32x8::ONE);
        let g = f32x8::ONE / (f32x8::ONE + ratio);
        let apart = e1 - e2;
        let skew = apart * apart / (f1 * f2 * sum);
        let polynomial = g.mul_add(g.mul_add(f32x8::splat(10.0), f32x8::ONE), f32x8::ONE);
        Self {
            e1,
            e2,
            angle,
            width: ratio.sqrt(),
            n: ((sum - f32x8::ONE) * in_plane).sqrt(),
            correction: (skew * (f32x8::ONE - g) * polynomial).mul_add(f32x8::splat(1.0 / 12.0), f32x8::ONE),
            value: a.scale * b.scale * balanced.value(e1, e2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{product, product_bound, product_integral};
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn random_axis(random: &mut Pcg64Mcg) -> [f64; 3] {
        super::super::pair::unit(std::array::from_fn(|_| random.random_range(-1.0..1.0)))
    }

    /// Pairs whose second axis is within a few widths of the first.
    fn pairs(count: usize) -> Vec<(Lobe, Lobe)> {
        let mut random = Pcg64Mcg::seed_from_u64(11);
        (0..count)
            .map(|_| {
                let exponents: [f64; 2] = std::array::from_fn(|_| 10f64.powf(random.random_range(-1.5..5.0)));
                let (axis, other) = (random_axis(&mut random), random_axis(&mut random));
                let reach = random.random_range(0.0..4.0) / (1.0 + exponents[0].min(exponents[1])).sqrt();
                let near = super::super::pair::unit(std::array::from_fn(|i| axis[i] + reach * other[i]));
                let lobe = |axis: [f64; 3], exponent: f64, scale: f64| {
                    // Numbers that f32 can hold, so that only the computation differs.
                    let round = |x: f64| f64::from(x as f32);
                    Lobe { axis: axis.map(round), exponent: round(exponent), scale }
                };
                (lobe(axis, exponents[0], 1.5), lobe(near, exponents[1], -2.0))
            })
            .collect()
    }

    #[test]
    fn agrees_with_the_reference() {
        let tables = ProductRule::ALL.map(LobeTable::build);
        for (a, b) in pairs(1000) {
            let table = &tables[0];
            let (a8, b8) = (Lobe8::splat(&a), Lobe8::splat(&b));
            let integral = product_integral(&a, &b);
            let found = f64::from(table.product_integral8(&a8, &b8).to_array()[0]);
            // Rounding of the axes in f32 moves the logarithm by up to 1e-7 times exponent times angle.
            assert!((found - integral).abs() < 8e-4 * integral.abs() + 1e-6, "{a:?} {b:?}: {found} {integral}");
            let bound = f64::from(a8.product_bound(&b8).to_array()[1]);
            assert!((bound - product_bound(&a, &b)).abs() < 4e-4 * bound + 1e-12);
            for table in &tables {
                let rule = table.rule();
                let (found, expected) = (table.product8(&a8, &b8).lane(3), product(&a, &b, rule));
                // The published rule is rough below an exponent of 1.
                let smooth = rule == ProductRule::Moments || a.exponent.min(b.exponent) >= 1.0;
                let close = if smooth { 4e-3 } else { 0.1 };
                let exponent = (found.exponent + 1.0) / (expected.exponent + 1.0);
                assert!((exponent - 1.0).abs() < close, "{a:?} {b:?} {rule:?}: {exponent}");
                let difference = (found.integral() - expected.integral()).abs();
                assert!(difference < close * integral.abs() + 1e-6, "{a:?} {b:?} {rule:?}");
                // Squared distance of the axes in widths of the lobe.
                let axis = super::super::pair::unit(found.axis);
                let off: f64 = (0..3).map(|i| (axis[i] - expected.axis[i]).powi(2)).sum();
                assert!(off * (1.0 + expected.exponent) < 1e-5, "{a:?} {b:?} {rule:?}: {off}");
                if rule != ProductRule::Published {
                    let kept = found.integral() / f64::from(table.product_integral8(&a8, &b8).to_array()[0]);
                    assert!((kept - 1.0).abs() < 1e-5 || integral.abs() < 1e-30);
                }
            }
        }
    }

    #[test]
    fn extremes_are_finite_and_lanes_are_independent() {
        let tables = ProductRule::ALL.map(LobeTable::build);
        let axes = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1e-30], [0.6, 0.0, 0.8]];
        let exponents = [0.0, 1.0, 1e5, 1e7, f64::INFINITY, f64::NAN, -3.0, 0.01];
        let mut lobes = Vec::new();
        for axis in axes {
            lobes.extend(exponents.map(|exponent| Lobe { axis, exponent, scale: 2.0 }));
        }
        let gather = |lobes: &[Lobe]| {
            let lanes = |get: &dyn Fn(&Lobe) -> f64| {
                f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| get(&lobes[lane % lobes.len()]) as f32))
            };
            Lobe8 {
                axis: std::array::from_fn(|i| lanes(&|lobe| lobe.axis[i])),
                exponent: lanes(&|lobe| lobe.exponent),
                scale: lanes(&|lobe| lobe.scale),
            }
        };
        let bits = |lobe: Lobe| [lobe.axis[0], lobe.axis[1], lobe.axis[2], lobe.exponent, lobe.scale].map(f64::to_bits);
        for first in &lobes {
            for others in lobes.chunks(8) {
                for table in &tables {
                    let (a8, b8) = (Lobe8::splat(first), gather(others));
                    let together = table.product8(&a8, &b8);
                    let integrals = table.product_integral8(&a8, &b8).to_array();
                    let bounds = a8.product_bound(&b8).to_array();
                    for (lane, other) in others.iter().enumerate() {
                        let alone = table.product8(&a8, &Lobe8::splat(other));
                        assert_eq!(bits(together.lane(lane)), bits(alone.lane(0)), "{first:?} {other:?}");
                        let lobe = together.lane(lane);
                        assert!(lobe.exponent.is_finite() && lobe.scale.is_finite() && lobe.scale >= 0.0);
                        assert!(lobe.axis.iter().all(|x| x.is_finite()));
                        assert!(integrals[lane].is_finite() && integrals[lane] >= 0.0 && bounds[lane].is_finite());
                    }
                }
            }
        }
        let none = Lobe8 { scale: f32x8::ZERO, ..Lobe8::splat(&lobes[1]) };
        let table = &tables[2];
        assert_eq!(table.product8(&none, &Lobe8::splat(&lobes[2])).scale, f32x8::ZERO);
        let bad = Lobe8 { axis: [f32x8::splat(f32::NAN); 3], ..none };
        let _ = table.product8(&bad, &Lobe8::splat(&lobes[2]));
    }
}
