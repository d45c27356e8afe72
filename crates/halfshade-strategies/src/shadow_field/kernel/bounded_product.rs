//! The triple product of visibility and transfer, `U = V ρ̂` [Tamura2006, figure 3], held to what such a function can be.
//!
//! Products of band-limited functions leave the range of what they stand for, and products of many grow without end. But
//! for `0 ≤ V ≤ 1`, with `I = ∫ ρ`, `f = ∫ U / I` and `ρ ≤ m`,
//!
//! ```text
//! 0 ≤ f ≤ 1        |U - f ρ|² ≤ m I g (1 - λ g),   g = min(f, 1 - f)
//! ```
//!
//! which is largest where V is 0 or 1 and 1 where ρ is largest. λ = 1 for any ρ; for the clamped cosine over π, of which
//! `∫ ρ² = 2/(3π)` is known, λ = 4/3. A projection is no longer than what it is of, and the first coefficient is exact, so
//! that vectors of true functions are left alone. Under constant light `f` is what reaches of the unshadowed.

use halfshade_sh::kernel::{self, FULL, ShBatch};
use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// ρ̂, and how far from a part of it U may be.
pub(crate) struct Bound<'a, const N: usize> {
    shape: &'a ShBatch<N>,
    /// 1 over the first coefficient, or 0.
    inverse_first: f32x8,
    /// m I.
    room: f32x8,
    /// λ.
    bend: f32x8,
}

impl<'a, const N: usize> Bound<'a, N> {
    /// The bound under the clamped cosine over π.
    pub(crate) fn diffuse(cosine: &'a ShBatch<N>) -> Self {
        Self::new(cosine, f32x8::splat(FRAC_1_PI), f32x8::splat(4.0 / 3.0))
    }

    /// The bound under a lobe, at most 1.
    pub(crate) fn lobe(shape: &'a ShBatch<N>) -> Self {
        Self::new(shape, shape[0].abs() * f32x8::splat(FULL), f32x8::ONE)
    }

    fn new(shape: &'a ShBatch<N>, room: f32x8, bend: f32x8) -> Self {
        let first = shape[0];
        let is_some = first.abs().simd_gt(f32x8::splat(f32::MIN_POSITIVE));
        Self { shape, inverse_first: is_some.select(f32x8::ONE / first, f32x8::ZERO), room, bend }
    }

    /// ρ̂ itself.
    pub(crate) fn shape(&self) -> &ShBatch<N> {
        self.shape
    }

    /// U times the visibility; never more of it than before.
    #[inline(always)]
    pub(crate) fn times(&self, unit: &ShBatch<N>, visible: &ShBatch<N>) -> ShBatch<N> {
        let mut product = kernel::product(visible, unit);
        self.hold(&mut product, unit[0]);
        product
    }

    #[inline(always)]
    fn hold(&self, unit: &mut ShBatch<N>, before: f32x8) {
        let part = unit[0] * self.inverse_first;
        let held = part.max(f32x8::ZERO).min((before * self.inverse_first).max(f32x8::ZERO).min(f32x8::ONE));
        let least = held.min(f32x8::ONE - held);
        let room = self.room * least * self.bend.mul_neg_add(least, f32x8::ONE);
        let away = |i: usize, unit: &ShBatch<N>| held.mul_neg_add(self.shape[i], unit[i]);
        let energy = (1..N).fold(f32x8::ZERO, |sum, i| {
            let away = away(i, unit);
            away.mul_add(away, sum)
        });
        let far = energy.simd_gt(room);
        let over = far | held.simd_ne(part);
        // Most batches are what they can be.
        if over.any() {
            let shrink = far.select((room / energy).sqrt(), f32x8::ONE);
            unit[0] = over.select(held * self.shape[0], unit[0]);
            for i in 1..N {
                unit[i] = over.select(shrink.mul_add(away(i, unit), held * self.shape[i]), unit[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;
    use glam::Vec3;
    use halfshade_sh::{basis, quadrature::SphereQuadrature};

    const N: usize = 16;

    fn projected(value: impl Fn(Vec3) -> f64) -> ShBatch<N> {
        let mut sum = [0.0; N];
        for (direction, weight) in SphereQuadrature::exact_to(120).points() {
            let value = weight * value(Vec3::from(direction.map(|x| x as f32)));
            sum.iter_mut().zip(basis::evaluate(4, direction)).for_each(|(sum, y)| *sum += value * y);
        }
        sum.map(|value| f32x8::splat(value as f32))
    }

    fn distance(a: &ShBatch<N>, b: &ShBatch<N>) -> f32 {
        a.iter().zip(b).map(|(a, b)| (*a - *b).as_array()[5].powi(2)).sum::<f32>().sqrt()
    }

    /// Caps that hide and caps that alone are open, the one around the normal among them, which leaves no room.
    #[test]
    fn what_true_functions_are_is_left_alone() {
        let mut random = random(5);
        let normal = Vec3::new(0.48, 0.6, 0.64);
        let cosine = |direction: Vec3| f64::from(direction.dot(normal).max(0.0)) / std::f64::consts::PI;
        let lobe = |direction: Vec3| f64::from(direction.dot(Vec3::Z).max(0.0)).powi(9);
        let shapes = [projected(cosine), projected(lobe)];
        let bounds = [Bound::diffuse(&shapes[0]), Bound::lobe(&shapes[1])];
        for case in 0..120 {
            let axis =
                if case % 3 == 0 { normal } else { Vec3::new(random(), random(), random()).normalize_or(Vec3::Y) };
            let (least, inside) = (random(), case % 2 == 0);
            let visible = |direction: Vec3| if (direction.dot(axis) > least) == inside { 1.0 } else { 0.0 };
            let units = [projected(|v| visible(v) * cosine(v)), projected(|v| visible(v) * lobe(v))];
            for ((unit, bound), shape) in units.iter().zip(&bounds).zip(&shapes) {
                let mut held = *unit;
                bound.hold(&mut held, shape[0]);
                // The quadrature's own error at the edge.
                assert!(distance(&held, unit) < 2e-3, "{case}: {}", distance(&held, unit));
            }
        }
    }

    #[test]
    fn whatever_comes_is_held() {
        let mut random = random(6);
        let shape = projected(|direction| f64::from(direction.y.max(0.0)) / std::f64::consts::PI);
        let bound = Bound::diffuse(&shape);
        let longest = shape.iter().map(|value| value.as_array()[0].powi(2)).sum::<f32>().sqrt();
        for case in 0..400 {
            let size = 10f32.powi(case % 30 - 10);
            let mut unit: ShBatch<N> = std::array::from_fn(|_| f32x8::splat(size * random()));
            let before = f32x8::splat(0.3 * (1.0 + random())) * shape[0];
            bound.hold(&mut unit, before);
            let (first, most) = (unit[0].as_array()[2], before.as_array()[2]);
            assert!(first >= 0.0 && first <= most * 1.000_001, "{case}: {first} {most}");
            assert!(distance(&unit, &[f32x8::ZERO; N]) < 1.01 * longest + 0.01, "{case}");
        }
    }

    /// The same blocker again and again takes away what it takes away, and no more than there is.
    #[test]
    fn a_thousand_products_are_one() {
        let normal = Vec3::Y;
        let shape = projected(|direction| f64::from(direction.dot(normal).max(0.0)) / std::f64::consts::PI);
        let visible = projected(|direction| f64::from(u8::from(direction.dot(Vec3::new(0.0, 0.8, 0.6)) < 0.7)));
        let bound = Bound::diffuse(&shape);
        let part = |unit: &ShBatch<N>| (unit[0] / shape[0]).as_array()[0];
        let mut unit = bound.times(&shape, &visible);
        let once = part(&unit);
        for _ in 0..1000 {
            let before = part(&unit);
            unit = bound.times(&unit, &visible);
            assert!((0.0..=before + 1e-6).contains(&part(&unit)));
        }
        assert!(once > 0.3 && once < 0.7);
    }

    #[test]
    fn nothing_reflected_is_nothing() {
        let none = [f32x8::ZERO; N];
        let product = Bound::lobe(&none).times(&none, &projected(|_| 1.0));
        assert!(product.iter().all(|value| *value == f32x8::ZERO));
    }
}
