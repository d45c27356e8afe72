//! The part of a cap of directions that another cap hides.

use wide::f32x8;

/// Part of the solid angle of a cap of angular radius `lamp` that one of angular radius `cap` hides, in [0, 1]; the angle
/// between their middles is `apart`. Both are at most π/2, the lamp's isn't 0.
///
/// Where they cross, the two are sectors about their middles less the two triangles that have the middles and a crossing as
/// corners. With s half the sum of the sides,
///
/// ```text
/// A = 2 α (1 - cos σ) + 2 β (1 - cos θ) - 2 E
/// tan²(α/2) = sin(s-σ) sin(s-Δ) / (sin s sin(s-θ))      α at the lamp's middle, β with σ and θ swapped
/// tan²(E/4) = tan(s/2) tan((s-σ)/2) tan((s-θ)/2) tan((s-Δ)/2)
/// ```
///
/// all of which keep their digits for small caps. Error: 2e-4 of the lamp. \[Oat2007\] has the same area by arc cosines, and
/// interpolates it.
#[inline(always)]
pub(crate) fn hidden_of_cap(lamp: f32x8, cap: f32x8, apart: f32x8) -> f32x8 {
    let versine = |angle: f32x8| {
        let (half, _) = (angle * f32x8::HALF).sin_cos();
        half * half * f32x8::splat(2.0)
    };
    let (whole, hiding) = (versine(lamp), versine(cap));
    let crosses = apart.simd_lt(lamp + cap);
    let within = (hiding / whole).fast_min(f32x8::ONE);
    let is_within = apart.simd_le((lamp - cap).abs());
    let part = is_within.select(within, f32x8::ZERO);
    if (crosses & !is_within).none() {
        return crosses.select(part, f32x8::ZERO);
    }
    let half_sum = (lamp + cap + apart) * f32x8::HALF;
    let halves = [half_sum, half_sum - lamp, half_sum - cap, half_sum - apart];
    let halves = halves.map(|side| (side.fast_max(f32x8::ZERO) * f32x8::HALF).sin_cos());
    let sines = halves.map(|(sin, cos)| (sin * cos).fast_max(f32x8::ZERO));
    let [sum, less_lamp, less_cap, less_apart] = sines;
    let twice_atan =
        |above: f32x8, below: f32x8| above.sqrt().atan2(below.fast_max(f32x8::splat(1e-37)).sqrt()) * f32x8::splat(2.0);
    let alpha = twice_atan(less_lamp * less_apart, sum * less_cap);
    let beta = twice_atan(less_cap * less_apart, sum * less_lamp);
    let product = |of: fn((f32x8, f32x8)) -> f32x8| {
        halves.map(of).into_iter().fold(f32x8::ONE, |all, one| all * one.fast_max(f32x8::ZERO))
    };
    let excess = twice_atan(product(|(sin, _)| sin), product(|(_, cos)| cos)) * f32x8::splat(2.0);
    // In halves and over the lamp's: 2π times the versine is a solid angle.
    let area = alpha.mul_add(whole, beta.mul_add(hiding, -excess)) * f32x8::splat(std::f32::consts::FRAC_1_PI);
    let lens = (area / whole).fast_max(f32x8::ZERO).fast_min(within);
    crosses.select(is_within.select(part, lens), f32x8::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Rings about the lamp's middle: the part of each that lies within the cap.
    fn quadrature(lamp: f64, cap: f64, apart: f64) -> f64 {
        let rings = 20_000;
        let mut hidden = 0.0;
        for ring in 0..rings {
            let versine = (1.0 - lamp.cos()) * (f64::from(ring) + 0.5) / f64::from(rings);
            let polar = (1.0 - versine).acos();
            // cos(cap) = cos(apart) cos(polar) + sin(apart) sin(polar) cos(turn)
            let turn = (cap.cos() - apart.cos() * polar.cos()) / (apart.sin() * polar.sin()).max(1e-300);
            hidden += turn.clamp(-1.0, 1.0).acos() / PI;
        }
        hidden / f64::from(rings)
    }

    #[test]
    fn agrees_with_quadrature_for_specks_and_hemispheres() {
        let mut partly = 0;
        for lamp in [0.00465, 0.05, 0.3, 1.0, 0.5 * PI] {
            for relative in [0.1, 0.7, 1.0, 1.3, 4.0, 100.0] {
                let cap = f64::min(lamp * relative, 0.5 * PI);
                for step in 0..40 {
                    let apart = f64::min((lamp + cap) * f64::from(step) / 38.0, PI);
                    let found =
                        hidden_of_cap(f32x8::splat(lamp as f32), f32x8::splat(cap as f32), f32x8::splat(apart as f32));
                    let (found, exact) = (f64::from(found.to_array()[1]), quadrature(lamp, cap, apart));
                    assert!((found - exact).abs() < 5e-4, "{lamp} {cap} {apart}: {found} {exact}");
                    partly += usize::from(exact > 0.01 && exact < 0.99);
                }
            }
        }
        assert!(partly > 300, "{partly}");
    }
}
