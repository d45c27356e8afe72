//! Subsurface scattering: light that enters a translucent object in one place and leaves it in another.

use crate::{SceneError, light::is_grey};
use glam::Vec3;
use serde::Serialize;
use std::ops::RangeInclusive;

/// A translucent medium below the surface of an object, by the dipole's diffusion approximation [Jensen2001, 2.1, eq. 4 and 5].
///
/// Light that enters is refracted, light that leaves does so in all directions alike, as [Dachsbacher2017, subsurface scattering]
/// simplifies it:
///
/// ```text
/// L(x)   = albedo(x)/π ∫ R_d(|x - y|) E_t(y) dA(y)              over the front of the object's own surface
/// E_t(y) = ∫ F_t(η, n·ω) L_in(y, ω) V(y, ω) max(n·ω, 0) dω      F_t = 1 - Fresnel's reflectance of unpolarized light
///
/// R_d(r) = α'/(4π) Σ over s in {r, v} z_s (σ_tr + 1/d_s) exp(-σ_tr d_s)/d_s²
/// d_s = √(r² + z_s²)    z_r = 1/σ_t'    z_v = z_r (1 + 4A/3)
/// σ_t' = σ_a + σ_s'     α' = σ_s'/σ_t'  σ_tr = √(3 σ_a σ_t')
/// A = (1 + F_dr)/(1 - F_dr)             F_dr = -1.440/η² + 0.710/η + 0.668 + 0.0636 η
/// ```
///
/// with distances straight through the object, in metres of the world. An endless plane gives off `∫ R_d dA` of what enters it,
/// at most 1 ([`Self::validate`] bounds η so that A is positive). The albedo tints what leaves. Its diffuse part takes the place of the
/// material's; gloss stays on top. Rays it stops as any surface does; from behind, within the object, it is black.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Subsurface {
    /// σ_a per channel, 1/m: 0 to [`MAX_COEFFICIENT`].
    pub absorption: Vec3,
    /// σ_s' per channel, 1/m: 0 to [`MAX_COEFFICIENT`], and with the absorption at least [`MIN_EXTINCTION`].
    pub reduced_scattering: Vec3,
    /// η of the object over that of what is around it, within [`REFRACTIVE_INDICES`].
    pub refractive_index: f32,
}

/// Largest coefficient: a mean free path of a micrometre.
pub const MAX_COEFFICIENT: f32 = 1e6;

/// Smallest sum of absorption and reduced scattering: a mean free path of a thousand kilometres.
pub const MIN_EXTINCTION: f32 = 1e-6;

/// Refractive indices for which the polynomial of F_dr holds.
pub const REFRACTIVE_INDICES: RangeInclusive<f32> = 1.0..=2.5;

impl Subsurface {
    /// Whether all channels scatter alike.
    pub fn is_grey(&self) -> bool {
        is_grey(self.absorption) && is_grey(self.reduced_scattering)
    }

    /// Error for numbers that no medium has.
    pub fn validate(&self) -> Result<(), SceneError> {
        let Self { absorption, reduced_scattering, refractive_index } = *self;
        for (name, coefficients) in [("absorption", absorption), ("reduced_scattering", reduced_scattering)] {
            if !coefficients.to_array().iter().all(|value| (0.0..=MAX_COEFFICIENT).contains(value)) {
                let problem = format!("{name} = {coefficients} must be within [0, {MAX_COEFFICIENT:e}] per metre");
                return Err(SceneError::new(problem));
            }
        }
        if (absorption + reduced_scattering).min_element() < MIN_EXTINCTION {
            let problem = "absorption and reduced_scattering must add up to at least 1e-6 per metre in each channel";
            return Err(SceneError::new(problem).with_remedy("leave subsurface out where light isn't scattered"));
        }
        if !REFRACTIVE_INDICES.contains(&refractive_index) {
            let (least, most) = REFRACTIVE_INDICES.into_inner();
            let problem = format!("refractive_index = {refractive_index} must be within [{least}, {most}]");
            return Err(SceneError::new(problem));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_numbers_are_named() {
        let medium = |absorption: f32, scattering: f32, refractive_index: f32| Subsurface {
            absorption: Vec3::splat(absorption),
            reduced_scattering: Vec3::splat(scattering),
            refractive_index,
        };
        for good in [medium(0.0, 1e-6, 1.0), medium(1e6, 1e6, 2.5), medium(1e-6, 0.0, 1.3)] {
            good.validate().unwrap();
        }
        for (bad, part) in [
            (medium(-1.0, 1.0, 1.3), "absorption ="),
            (medium(f32::NAN, 1.0, 1.3), "absorption ="),
            (medium(1.0, 1.1e6, 1.3), "reduced_scattering ="),
            (medium(1.0, f32::INFINITY, 1.3), "reduced_scattering ="),
            (medium(0.0, 0.0, 1.3), "add up"),
            (medium(1.0, 1.0, 0.99), "refractive_index"),
            (medium(1.0, 1.0, f32::NAN), "refractive_index"),
        ] {
            let error = bad.validate().unwrap_err().to_string();
            assert!(error.contains(part), "{bad:?}: {error}");
        }
    }
}
