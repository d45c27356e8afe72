//! Lobes of glossy reflectance, `max(a·ω, 0)^e` [Meunier2009, eq. 30], each looked along in a few directions of its own.
//!
//! The K directions lie along a spiral of the golden angle, each for as much of the lobe: the part w of it lies within
//! 1 - cos φ = 1 - (1 - w)^(1/(e+1)). A direction's cell has the solid angle 2π / ((e + 1) K cos^e φ), which grows outwards. However
//! sharp the lobe, it has as many directions.

use super::bundle::Bundle;
use glam::Vec3;
use halfshade_scene::Lobe;
use halfshade_sh::quadrature::GOLDEN_ANGLE;
use wide::f32x8;

/// Directions of a lobe, the same for all but for the exponent.
#[derive(Debug, Clone)]
pub(crate) struct LobeSpiral {
    /// -log of the part without, eight by eight.
    pub(crate) logs: Vec<f32x8>,
    /// Cosine and sine of the turn.
    pub(crate) turn: Vec<[f32x8; 2]>,
    /// How many there are.
    pub(crate) count: usize,
}

/// A lobe of one receiver.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LobeView {
    pub(crate) bundle: Bundle,
    exponent: f32,
    /// 1 / (e + 1): the versine of a cap of as many steradians.
    pub(crate) versine: f32,
    /// Sharpness along the axis.
    sharpness: f32,
}

impl LobeSpiral {
    /// So many directions, a multiple of 8.
    pub(crate) fn new(count: usize) -> Self {
        let lanes = |first: usize, of: &dyn Fn(f64) -> f64| {
            f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| of((first + lane) as f64) as f32))
        };
        let firsts = (0..count).step_by(8);
        let turn = |first: usize| [f64::cos, f64::sin].map(|of| lanes(first, &|i| of(GOLDEN_ANGLE * i)));
        Self {
            logs: firsts.clone().map(|first| lanes(first, &|i| -(-(i + 0.5) / count as f64).ln_1p())).collect(),
            turn: firsts.map(turn).collect(),
            count,
        }
    }
}

impl LobeView {
    /// That of a lobe in light space; what is as far as `distance` hides nothing.
    pub(crate) fn new(lobe: &Lobe, distance: f32, edge: f32, count: usize) -> Self {
        let (exponent, versine) = (lobe.exponent, 1.0 / (lobe.exponent + 1.0));
        let sharpness = 1.0 / (edge * (2.0 * versine / count as f32).sqrt());
        // The outermost has half a direction's part without.
        let log = (2.0 * count as f32).ln();
        let outermost = (2.0 * -(-log * versine).exp_m1()).sqrt();
        let narrowest = sharpness * (-0.5 * exponent * versine * log).exp();
        // The mean of the square root of an even part is 2/3.
        let mean = sharpness * (2.0 / 3.0 * exponent + 1.0) * versine;
        Self {
            bundle: Bundle::new(lobe.axis, distance, mean, [outermost, 1.0 / narrowest]),
            exponent,
            versine,
            sharpness,
        }
    }

    /// Eight of its directions less its axis, along the bundle's axes; for what is known in cells of a versine only, those of
    /// a sharper lobe fill a cell of this `least` one.
    #[inline(always)]
    pub(crate) fn shift(&self, least: f32, log: f32x8, [cos, sin]: [f32x8; 2]) -> [f32x8; 3] {
        let fall = -(log * f32x8::splat(-self.versine.max(least))).exp_m1();
        let across = (fall * (f32x8::splat(2.0) - fall)).fast_max(f32x8::ZERO).sqrt();
        [across * cos, across * sin, -fall]
    }

    /// 1 over the width of the edges of eight directions.
    #[inline(always)]
    pub(crate) fn sharpness(&self, log: f32x8) -> f32x8 {
        f32x8::splat(self.sharpness) * (log * f32x8::splat(-0.5 * self.exponent * self.versine)).exp()
    }
}

/// The power of a lobe in directions by 1 less their cosine with its axis.
#[inline(always)]
pub(crate) fn power(exponent: f32, versine: f32x8) -> f32x8 {
    let within = versine.simd_lt(f32x8::ONE);
    let log = (-within.select(versine, f32x8::ZERO)).ln_1p();
    within.select((f32x8::splat(exponent) * log).exp(), f32x8::ZERO)
}

/// The factor of a lobe beside its power in directions with cosine `above`: the cosine, or how much of their cells is above the horizon.
#[inline(always)]
pub(crate) fn horizon(lobe: &Lobe, above: f32x8, sharpness: f32x8) -> f32x8 {
    if lobe.times_cosine {
        above.fast_max(f32x8::ZERO)
    } else {
        above.mul_add(sharpness, f32x8::HALF).fast_max(f32x8::ZERO).fast_min(f32x8::ONE)
    }
}

/// Cosines of directions with a unit normal, by their shifts.
#[inline(always)]
pub(crate) fn cosines(bundle: &Bundle, normal: Vec3, shift: &[f32x8; 3]) -> f32x8 {
    let shift = bundle.in_light_space(shift);
    let level = f32x8::splat(normal.dot(bundle.axis));
    (0..3).fold(level, |sum, k| shift[k].mul_add(f32x8::splat(normal[k]), sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of powers over a lobe have closed forms: of (a·ω)^p it is (e + 1) / (e + p + 1).
    #[test]
    fn directions_are_spread_as_the_lobe_is() {
        let spiral = LobeSpiral::new(64);
        for exponent in [0.0, 1.0, 12.0, 300.0, 1e5] {
            let lobe = Lobe { axis: Vec3::new(0.48, 0.6, 0.64), exponent, scale: Vec3::ONE, times_cosine: false };
            let view = LobeView::new(&lobe, f32::INFINITY, 1.0, spiral.count);
            let (mut sum, mut middle) = (0.0, Vec3::ZERO);
            for (&log, &turn) in spiral.logs.iter().zip(&spiral.turn) {
                let shift = view.shift(0.0, log, turn);
                let versine = view.bundle.versines_to(lobe.axis, &shift);
                sum += power(exponent + 1.0, versine).reduce_add() / 64.0;
                middle += Vec3::from(view.bundle.directions(&shift).map(f32x8::reduce_add)) / 64.0;
            }
            let expected = (exponent + 1.0) / (2.0 * exponent + 2.0);
            assert!((sum - expected).abs() < 1e-3, "{exponent}: {sum} {expected}");
            let expected = (exponent + 1.0) / (exponent + 2.0) * lobe.axis;
            assert!(middle.distance(expected) < 0.05 / (exponent + 1.0).sqrt(), "{exponent}: {middle} {expected}");
        }
    }
}
