//! BRDFs as SH vectors: what receivers reflect beside their diffuse part.

use super::fields::ShFields;
use glam::Vec3;
use halfshade_scene::{EyeLobes, Lobes, Receivers, lobe::MAX_LOBES};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use std::f32::consts::{PI, TAU};
use wide::f32x8;

/// Glossy lobes of eight receivers, the k-th of each side by side.
pub(super) struct GlossBatch<const N: usize> {
    /// How many there are at most.
    pub(super) count: usize,
    /// ρ̂ of each lobe: its power times the cosine, or the horizon.
    pub(super) shapes: [ShBatch<N>; MAX_LOBES],
    /// Red, green, blue.
    pub(super) scales: [[f32x8; 3]; MAX_LOBES],
}

impl<const N: usize> GlossBatch<N> {
    /// Lobes of the receivers `lane(0)` to `lane(7)`, whose `cosine` is known: clamped, over π. In light space.
    pub(super) fn new(
        fields: &ShFields,
        eye_lobes: &EyeLobes,
        receivers: &Receivers<'_>,
        lane: impl Fn(usize) -> usize,
        (normal, cosine): (&[f32x8; 3], &ShBatch<N>),
    ) -> Self {
        let lobes: [Lobes; LANES] = std::array::from_fn(|k| eye_lobes.at(receivers, lane(k)));
        let count = lobes.iter().map(|lobes| lobes.len()).max().unwrap_or(0).min(MAX_LOBES);
        let mut batch = Self { count, shapes: [[f32x8::ZERO; N]; MAX_LOBES], scales: [[f32x8::ZERO; 3]; MAX_LOBES] };
        let horizon = power::<N>(*normal, f32x8::ZERO);
        for number in 0..count {
            let mut axes = [Vec3::Y; LANES];
            let mut exponents = [0.0; LANES];
            let mut scales = [[0.0; LANES]; 3];
            let mut times_cosine = [0.0_f32; LANES];
            for (k, lobes) in lobes.iter().enumerate() {
                let Some(lobe) = lobes.get(number) else { continue };
                axes[k] = fields.arrangement.direction(lobe.axis);
                exponents[k] = lobe.exponent;
                (0..3).for_each(|channel| scales[channel][k] = lobe.scale[channel]);
                times_cosine[k] = f32::from(u8::from(lobe.times_cosine));
            }
            let axis = std::array::from_fn(|i| f32x8::from(axes.map(|axis| axis[i])));
            let power = power::<N>(axis, exponents.into());
            let with_cosine = f32x8::from(times_cosine).simd_gt(f32x8::ZERO);
            let above: ShBatch<N> =
                std::array::from_fn(|i| with_cosine.select(cosine[i] * f32x8::splat(PI), horizon[i]));
            batch.shapes[number] = kernel::product(&power, &above);
            batch.scales[number] = scales.map(f32x8::from);
        }
        batch
    }
}

/// `max(a·v, 0)^e` as SH vectors: band l is `2π I_l y_l(a)` with `I_l = ∫_0^1 x^e P_l(x) dx`, for which
/// `I_l = I_{l-2} (e - l + 2)/(e + l + 1)` from `I_0 = 1/(e + 1)` and `I_1 = 1/(e + 2)`.
fn power<const N: usize>(axis: [f32x8; 3], exponent: f32x8) -> ShBatch<N> {
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
            let found = power::<64>(axis.map(f32x8::splat), f32x8::splat(exponent));
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
