//! The product of the sun and diffuse reflectance: a sun is too small for any table, and needs none.
//!
//! ```text
//! L_ρ(n)_i = E(n)/π · ȳ_i        E(n) irradiance by the unblocked sun, ȳ_i mean of the basis over its cap
//! ```
//!
//! exact unless the horizon cuts the cap, where the mean is taken over all of it.

use super::dot_shared;
use crate::shared::vector::dot;
use glam::DVec3;
use halfshade_scene::light::{Sun, cap_irradiance, is_grey};
use halfshade_sh::{kernel::ShBatch, window::Window, zonal};
use std::f64::consts::{PI, TAU};
use wide::f32x8;

/// A sun, ready to be multiplied with visibility.
#[derive(Debug, Clone)]
pub struct SunLight {
    sun: Sun,
    /// Unit direction to its centre.
    pub direction: [f32; 3],
    /// Sine of its angular radius.
    pub sin_radius: f64,
    /// Reflected radiance of a white surface that faces the sun.
    pub perpendicular: [f32; 3],
    /// Mean of each basis function over the cap, windowed.
    pub basis: Vec<f32>,
}

impl SunLight {
    pub(crate) fn new(bands: usize, sun: Sun, window: Window) -> Self {
        let direction = sun.direction.as_dvec3().normalize_or(DVec3::Y);
        let radius = f64::from(sun.angular_radius);
        let versine = 2.0 * (0.5 * radius).sin().powi(2);
        let mean: Vec<f64> = zonal::cap_from_versine(bands, versine).iter().map(|g| g / (TAU * versine)).collect();
        let mut basis = zonal::rotate_to_axis(&mean, direction.to_array());
        window.apply(&mut basis);
        let sin_radius = radius.sin().clamp(0.0, 1.0);
        Self {
            sun,
            direction: direction.as_vec3().to_array(),
            sin_radius,
            perpendicular: sun.radiance.to_array().map(|channel| (f64::from(channel) * sin_radius * sin_radius) as f32),
            basis: basis.iter().map(|&value| value as f32).collect(),
        }
    }

    pub(crate) fn is_of(&self, sun: &Sun) -> bool {
        self.sun == *sun
    }

    pub(crate) fn is_grey(&self) -> bool {
        is_grey(self.sun.radiance)
    }

    /// Adds the light that eight white receivers reflect. With `clamp`, the visible share is held in [0, 1].
    #[inline(always)]
    pub(crate) fn add<const N: usize>(
        &self,
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
        clamp: bool,
        radiance: &mut [f32x8; 3],
    ) {
        let mut share = dot_shared(visibility, &self.basis);
        if clamp {
            share = share.max(f32x8::ZERO).min(f32x8::ONE);
        }
        share *= self.cosine(normal);
        for (sum, perpendicular) in radiance.iter_mut().zip(self.perpendicular) {
            *sum = share.mul_add(f32x8::splat(perpendicular), *sum);
        }
    }

    /// Irradiance as a share of that of a surface facing the sun: the clamped cosine, but where the horizon cuts the sun.
    #[inline(always)]
    fn cosine(&self, normal: &[f32x8; 3]) -> f32x8 {
        let cosine = dot(&self.direction.map(f32x8::splat), normal);
        // Wider than the radius by f32's rounding, so that both forms agree where they meet.
        let is_cut = cosine.abs().simd_lt(f32x8::splat(self.sin_radius as f32 * 1.000_001));
        let above = cosine.max(f32x8::ZERO);
        if !is_cut.any() {
            return above;
        }
        let full = PI * self.sin_radius * self.sin_radius;
        let partial = cosine.to_array().map(|c| (cap_irradiance(f64::from(c), self.sin_radius) / full) as f32);
        is_cut.select(f32x8::from(partial), above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::f32::consts::FRAC_1_PI;

    /// All visible: the sun's own closed form, above, through and below the horizon, for small and wide suns.
    #[test]
    fn unblocked_is_the_suns_irradiance() {
        for angular_radius in [1e-4f32, 0.00465, 0.3, 1.2] {
            let sun =
                Sun { direction: Vec3::new(0.6, 0.48, -0.64), angular_radius, radiance: Vec3::new(3.0, 2.0, 1.0) };
            let product = SunLight::new(4, sun, Window::None);
            let mut visibility = [f32x8::ZERO; 16];
            visibility[0] = f32x8::splat((4.0 * std::f32::consts::PI).sqrt());
            let side = sun.direction.any_orthonormal_vector();
            for step in 0..200 {
                let (sin, cos) = (std::f32::consts::PI * step as f32 / 199.0).sin_cos();
                let normal = (cos * sun.direction + sin * side).normalize();
                let mut radiance = [f32x8::ZERO; 3];
                product.add::<16>(&normal.to_array().map(f32x8::splat), &visibility, false, &mut radiance);
                let expected = sun.irradiance(normal) * FRAC_1_PI;
                let full = sun.radiance.x * angular_radius.sin().powi(2);
                for (channel, expected) in radiance.iter().zip(expected.to_array()) {
                    assert!((channel.to_array()[5] - expected).abs() < 2e-5 * full, "{angular_radius} {step}");
                }
            }
        }
    }
}
