//! Powers of a clamped cosine in spherical harmonics: the lobes of glossy reflectance.

use halfshade_sh::kernel::{self, ShBatch};
use std::f32::consts::TAU;
use wide::f32x8;

/// `max(a·v, 0)^e` as SH vectors: band l is `2π I_l y_l(a)` with `I_l = ∫_0^1 x^e P_l(x) dx`, for which
/// `I_l = I_{l-2} (e - l + 2)/(e + l + 1)` from `I_0 = 1/(e + 1)` and `I_1 = 1/(e + 2)`.
pub(crate) fn cosine_power<const N: usize>(axis: [f32x8; 3], exponent: f32x8) -> ShBatch<N> {
    let mut vector = kernel::basis::<f32x8, N>(axis);
    let mut integrals = [f32x8::ONE / (exponent + f32x8::ONE), f32x8::ONE / (exponent + f32x8::splat(2.0))];
    for l in 0..const { N.isqrt() } {
        if l >= 2 {
            let (less, more) = (f32x8::splat(2.0 - l as f32), f32x8::splat(l as f32 + 1.0));
            integrals[l % 2] *= (exponent + less) / (exponent + more);
        }
        for value in &mut vector[l * l..(l + 1) * (l + 1)] {
            *value *= f32x8::splat(TAU) * integrals[l % 2];
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_sh::{basis, quadrature::SphereQuadrature};

    #[test]
    fn powers_are_those_of_quadrature() {
        let axis = [0.48_f32, -0.6, 0.64];
        for exponent in [0.0_f32, 0.3, 1.0, 2.0, 7.5, 60.0] {
            let found = cosine_power::<64>(axis.map(f32x8::splat), f32x8::splat(exponent));
            let mut exact = vec![0.0; 64];
            // The edge of a hemisphere wants many points.
            for (direction, weight) in SphereQuadrature::exact_to(1200).points() {
                let cosine: f64 = direction.iter().zip(axis).map(|(d, a)| d * f64::from(a)).sum();
                let value = if cosine > 0.0 { weight * cosine.powf(exponent.into()) } else { 0.0 };
                exact.iter_mut().zip(basis::evaluate(8, direction)).for_each(|(sum, y)| *sum += value * y);
            }
            for (found, exact) in found.iter().zip(&exact) {
                let found = f64::from(found.as_array()[0]);
                assert!((found - exact).abs() < 3e-3, "{exponent}: {found} {exact}");
            }
        }
    }
}
