//! The part of a constant sky's light that one sphere hides.

use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// Part of the irradiance of a constant sky that a cap hides, in [0, 1]: [`halfshade_scene::light::cap_irradiance`] over π.
/// `cosine` is that of the angle between the normal and the cap's middle, `sine` that of its angular radius, at most 1.
///
/// ```text
/// wholly above the horizon, cos γ ≥ sin θ:   sin²θ cos γ
/// cut by it, with q = √(sin²θ - cos²γ):      (atan2(q, cos θ) - q cos θ + sin²θ cos γ · atan2(q, -cos γ cos θ)) / π
/// ```
///
/// Error: 1e-6. Source: Lambert's formula; \[Snyder1996\] has it for area lights.
#[inline(always)]
pub(crate) fn hidden_of_sky(cosine: f32x8, sine: f32x8) -> f32x8 {
    let whole = sine * sine * cosine.fast_max(f32x8::ZERO);
    let is_cut = cosine.abs().simd_lt(sine);
    if is_cut.none() {
        return whole;
    }
    let cos_radius = ((f32x8::ONE - sine) * (f32x8::ONE + sine)).fast_max(f32x8::ZERO).sqrt();
    let rim = ((sine - cosine) * (sine + cosine)).fast_max(f32x8::ZERO).sqrt();
    let horizon = rim.mul_neg_add(cos_radius, rim.atan2(cos_radius));
    let below = rim.atan2(-(cosine * cos_radius));
    let cut = (sine * sine * cosine).mul_add(below, horizon) * f32x8::splat(FRAC_1_PI);
    is_cut.select(cut.fast_max(f32x8::ZERO).fast_min(f32x8::ONE), whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::light::cap_irradiance;

    #[test]
    fn agrees_with_the_closed_form_in_double_precision() {
        for i in 0..=100 {
            let sine = i as f32 / 100.0;
            for k in -100..=100 {
                let cosine = k as f32 / 100.0;
                let found = hidden_of_sky(f32x8::splat(cosine), f32x8::splat(sine)).to_array()[3];
                let exact = cap_irradiance(f64::from(cosine), f64::from(sine)) / std::f64::consts::PI;
                assert!((f64::from(found) - exact).abs() < 1e-6, "{sine} {cosine}: {found} {exact}");
            }
        }
    }
}
