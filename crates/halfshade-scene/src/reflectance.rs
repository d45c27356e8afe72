//! Models of what a surface reflects beside its diffuse part ([Meunier2009, 5.1]).

use crate::lobe::{Lobe, Lobes, MAX_LOBES};
use crate::{Gloss, SceneError};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::f64::consts::TAU;

/// Highest exponent of a lobe: half of it lies within 0.3 degrees of its axis.
pub const MAX_EXPONENT: f32 = 1e5;

/// Highest value of a lobe along its axis, so that its product with any sensible radiance is a finite number.
pub const MAX_SCALE: f32 = 1e6;

/// Reflection of a surface beside the diffuse `albedo/π`.
///
/// With v the direction that light comes from, v_o that of the eye, n the normal, and r = 2 (n·v_o) n - v_o, the
/// integrand of outgoing radiance gains `L(v) V(v)` times what stands beside each model, in 1/steradian. All are 0 where
/// v or v_o lies below the horizon of n.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub enum Reflectance {
    /// Nothing: a diffuse surface.
    #[default]
    Lambert,
    /// `specular · max(r·v, 0)^exponent`: the original model without any cosine \[Phong1975\], as [Meunier2009, eq. 24]
    /// uses it (whose k_d is albedo/π). It conserves no energy and isn't reciprocal.
    Phong {
        /// k_s, per channel, 0 to [`MAX_SCALE`].
        specular: Vec3,
        /// e_s, 0 to [`MAX_EXPONENT`].
        exponent: f32,
    },
    /// `specular · (e + 2)/(2π) · max(r·v, 0)^e · max(n·v, 0)`: the modified model \[Lewis1994\]. A surface whose
    /// albedo and specular add up to at most 1 reflects no more than it receives.
    ModifiedPhong {
        /// Reflected fraction where r = n, per channel; with the albedo at most 1.
        specular: Vec3,
        /// e, 0 to [`MAX_EXPONENT`].
        exponent: f32,
    },
    /// `Σ scale · max(v^T M v_o, 0)^exponent · max(n·v, 0)` \[Lafortune1997\], at most [`MAX_LOBES`] terms.
    Lafortune {
        /// The terms.
        lobes: Vec<LafortuneLobe>,
    },
}

/// One term of a Lafortune model [Meunier2009, eq. 28].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LafortuneLobe {
    /// ρ or k, per channel: not negative.
    pub scale: Vec3,
    /// The diagonal of M, (C_x, C_y, C_z), in the frame of tangent, bitangent and normal. (-1, -1, 1) is a mirror's
    /// direction, (1, 1, 1) reflects back to where light came from, C_x ≠ C_y is anisotropic; lengths below 1 darken.
    /// `scale · max(|C_x|, |C_y|, |C_z|)^exponent` is at most [`MAX_SCALE`].
    pub axis: Vec3,
    /// 0 to [`MAX_EXPONENT`].
    pub exponent: f32,
}

/// The tangent that anisotropic lobes are about: horizontal, `+Y × n` normalized, towards the east as a globe's is; +X
/// where n is ±Y. In the object's own space, so that it turns with the object (see [`crate::EyeLobes`]).
pub fn tangent(normal: Vec3) -> Vec3 {
    Vec3::Y.cross(normal).try_normalize().unwrap_or(Vec3::X)
}

impl Reflectance {
    /// Whether anything is reflected beside the diffuse part.
    pub fn is_glossy(&self) -> bool {
        match self {
            Self::Lambert => false,
            Self::Phong { specular, .. } | Self::ModifiedPhong { specular, .. } => *specular != Vec3::ZERO,
            Self::Lafortune { lobes } => lobes.iter().any(|lobe| lobe.scale != Vec3::ZERO),
        }
    }

    /// The lobes of a receiver with unit `normal` and `tangent` as seen along unit `to_eye`, its specular scale and
    /// exponent multiplied by `gloss`. None if the eye lies below the horizon, or a vector isn't finite.
    ///
    /// [Meunier2009, eq. 30]: the axis of a Lafortune lobe is M v_o normalized, its scale `k · |M v_o|^e`.
    pub fn lobes(&self, gloss: Gloss, normal: Vec3, tangent: Vec3, to_eye: Vec3) -> Lobes {
        let mut lobes = Lobes::NONE;
        let (n, t, o) = (normal.as_dvec3(), tangent.as_dvec3(), to_eye.as_dvec3());
        let up = n.dot(o);
        if !(up > 0.0 && t.is_finite() && o.is_finite()) {
            return lobes;
        }
        let mirrored = (2.0 * up * n - o).normalize_or(n).as_vec3();
        match self {
            Self::Lambert => {}
            Self::Phong { specular, exponent } => lobes.push(Lobe {
                axis: mirrored,
                exponent: exponent * gloss.exponent,
                scale: *specular * gloss.specular,
                times_cosine: false,
            }),
            Self::ModifiedPhong { specular, exponent } => {
                let exponent = exponent * gloss.exponent;
                let normalization = ((f64::from(exponent) + 2.0) / TAU) as f32;
                lobes.push(Lobe {
                    axis: mirrored,
                    exponent,
                    scale: normalization * *specular * gloss.specular,
                    times_cosine: true,
                });
            }
            Self::Lafortune { lobes: terms } => {
                let b = n.cross(t);
                // Vectors whose lengths are off by a rounding of single precision would change a power of 10^5 by a percent.
                let local = DVec3::new(t.dot(o), b.dot(o), up).normalize_or_zero();
                for term in terms {
                    let stretched = term.axis.as_dvec3() * local;
                    let (length, exponent) = (stretched.length(), term.exponent * gloss.exponent);
                    let Some(axis) = stretched.try_normalize() else { continue };
                    // A power of a length below 1 may underflow, which is a black lobe.
                    let strength = (f64::from(exponent) * length.ln()).exp();
                    lobes.push(Lobe {
                        axis: (axis.x * t + axis.y * b + axis.z * n).normalize_or(n).as_vec3(),
                        exponent,
                        scale: (strength * (term.scale * gloss.specular).as_dvec3()).as_vec3(),
                        times_cosine: true,
                    });
                }
            }
        }
        lobes
    }

    /// Error for numbers that a surface with this albedo can't have.
    pub fn validate(&self, albedo: Vec3) -> Result<(), SceneError> {
        let wrong = |problem: String| Err(SceneError::new(problem));
        let exponent_fits = |e: f32| (0.0..=MAX_EXPONENT).contains(&e);
        let scale_fits = |k: Vec3| k.to_array().iter().all(|k| (0.0..=MAX_SCALE).contains(k));
        let in_unit = |k: Vec3| k.to_array().iter().all(|k| (0.0..=1.0).contains(k));
        match self {
            Self::Lambert => Ok(()),
            Self::Phong { exponent, .. } | Self::ModifiedPhong { exponent, .. } if !exponent_fits(*exponent) => {
                wrong(format!("exponent = {exponent} must be within [0, {MAX_EXPONENT}]"))
            }
            Self::Phong { specular, .. } if !scale_fits(*specular) => {
                wrong(format!("specular = {specular} must be finite, not negative, and at most {MAX_SCALE}"))
            }
            Self::Phong { .. } => Ok(()),
            Self::ModifiedPhong { specular, .. } => {
                // Room for the rounding of two decimal fractions.
                if !in_unit(*specular) || (albedo + *specular).max_element() > 1.0 + 1e-6 {
                    return wrong(format!("specular = {specular} must be within [0, 1], and with the albedo at most 1"));
                }
                Ok(())
            }
            Self::Lafortune { lobes } if !(1..=MAX_LOBES).contains(&lobes.len()) => {
                wrong(format!("lobes are {}, must be 1 to {MAX_LOBES}", lobes.len()))
            }
            Self::Lafortune { lobes } => lobes.iter().try_for_each(|lobe| {
                let LafortuneLobe { scale, axis, exponent } = *lobe;
                if !exponent_fits(exponent) {
                    return wrong(format!("exponent = {exponent} must be within [0, {MAX_EXPONENT}]"));
                }
                let longest = axis.as_dvec3().abs().max_element();
                let peak = scale.as_dvec3().max_element() * longest.powf(exponent.into());
                if !(axis.is_finite() && scale_fits(scale) && peak <= f64::from(MAX_SCALE)) {
                    return wrong(format!(
                        "scale = {scale} and axis = {axis}: must be finite, the scale not negative, and scale · |axis|^exponent at most {MAX_SCALE}"
                    ));
                }
                Ok(())
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Gloss = Gloss::NEUTRAL;

    fn directions(count: usize) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (sin, cos) = (2.399_963 * i as f64).sin_cos();
            let across = (1.0 - y * y).sqrt();
            DVec3::new(across * cos, y, across * sin)
        })
    }

    /// Every model as its paper writes it, against the lobes.
    #[test]
    fn lobes_are_the_formulas() {
        let specular = Vec3::new(0.2, 0.3, 0.1);
        let axes = [Vec3::new(-0.9, -0.7, 0.95), Vec3::new(0.8, 0.8, 0.9), Vec3::new(-1.01, -1.01, 0.3)];
        let terms = axes.map(|axis| LafortuneLobe { scale: specular, axis, exponent: 12.5 }).to_vec();
        for n in directions(17) {
            let t = tangent(n.as_vec3()).as_dvec3();
            assert!(t.dot(n).abs() < 1e-6 && (t.length() - 1.0).abs() < 1e-6);
            for o in directions(23) {
                let vectors = |model: &Reflectance| model.lobes(PLAIN, n.as_vec3(), t.as_vec3(), o.as_vec3());
                let phong = vectors(&Reflectance::Phong { specular, exponent: 30.0 });
                let modified = vectors(&Reflectance::ModifiedPhong { specular, exponent: 30.0 });
                let lafortune = vectors(&Reflectance::Lafortune { lobes: terms.clone() });
                for v in directions(31) {
                    let cosine = n.dot(v);
                    let seen = cosine > 0.0 && n.dot(o) > 0.0;
                    let power = (2.0 * n.dot(o) * n - o).dot(v).max(0.0).powi(30);
                    let by_formula = if seen { power } else { 0.0 };
                    let close = |found: DVec3, expected: f64| {
                        let scale = f64::from(specular.x);
                        assert!((found.x - scale * expected).abs() < 1e-5 * (1.0 + expected), "{found} {expected}");
                    };
                    close(phong.value(n, v), by_formula);
                    close(modified.value(n, v), by_formula * cosine * 32.0 / TAU);
                    let b = n.cross(t);
                    let sum: f64 = axes
                        .iter()
                        .map(|c| {
                            let c = c.as_dvec3();
                            let inner = c.x * v.dot(t) * o.dot(t) + c.y * v.dot(b) * o.dot(b) + c.z * cosine * n.dot(o);
                            inner.max(0.0).powf(12.5)
                        })
                        .sum();
                    close(lafortune.value(n, v), if seen { sum * cosine } else { 0.0 });
                }
            }
        }
    }

    #[test]
    fn a_mirror_like_lafortune_is_a_phong_with_its_cosine() {
        let (n, o) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.8, 0.6));
        let term = LafortuneLobe { scale: Vec3::ONE, axis: Vec3::new(-1.0, -1.0, 1.0), exponent: 50.0 };
        let lafortune = Reflectance::Lafortune { lobes: vec![term] }.lobes(PLAIN, n, tangent(n), o);
        let phong = Reflectance::Phong { specular: Vec3::ONE, exponent: 50.0 }.lobes(PLAIN, n, tangent(n), o);
        assert!(lafortune[0].axis.distance(phong[0].axis) < 1e-6);
        assert!((lafortune[0].scale - Vec3::ONE).abs().max_element() < 1e-5);
        assert!(lafortune[0].times_cosine && !phong[0].times_cosine);
    }

    #[test]
    fn factors_multiply_and_extremes_stay_finite() {
        let gloss = Gloss { specular: Vec3::new(0.5, 1.0, 0.0), exponent: 0.25 };
        let model = Reflectance::Phong { specular: Vec3::ONE, exponent: 100.0 };
        let lobe = model.lobes(gloss, Vec3::Y, Vec3::X, Vec3::Y)[0];
        assert_eq!((lobe.exponent, lobe.scale), (25.0, gloss.specular));
        let dark = Gloss { specular: Vec3::ZERO, ..gloss };
        assert!(model.lobes(dark, Vec3::Y, Vec3::X, Vec3::Y).is_empty());
        assert!(model.lobes(PLAIN, Vec3::Y, Vec3::X, Vec3::NEG_Y).is_empty());
        assert!(model.lobes(PLAIN, Vec3::Y, Vec3::X, Vec3::NAN).is_empty());
        for (axis, exponent) in [(1e-30, MAX_EXPONENT), (0.0, 0.0), (f32::MAX, MAX_EXPONENT), (1.0, MAX_EXPONENT)] {
            let term = LafortuneLobe { scale: Vec3::ONE, axis: Vec3::new(-axis, -axis, axis), exponent };
            let lobes = Reflectance::Lafortune { lobes: vec![term] }.lobes(PLAIN, Vec3::Y, Vec3::X, Vec3::Y);
            assert!(lobes.iter().all(|lobe| lobe.scale.is_finite() && lobe.axis.is_finite()));
        }
    }

    #[test]
    fn bad_numbers_are_named() {
        let albedo = Vec3::splat(0.6);
        let phong = |specular: f32, exponent| Reflectance::Phong { specular: Vec3::splat(specular), exponent };
        let modified =
            |specular: f32, exponent| Reflectance::ModifiedPhong { specular: Vec3::splat(specular), exponent };
        let lafortune = |scale: f32, axis: f32, exponent| Reflectance::Lafortune {
            lobes: vec![LafortuneLobe { scale: Vec3::splat(scale), axis: Vec3::splat(axis), exponent }],
        };
        for good in
            [phong(2.0, 1e5), phong(0.0, 0.0), modified(0.4, 50.0), lafortune(3.0, 1.0, 1e5), lafortune(0.1, 1.2, 50.0)]
        {
            good.validate(albedo).unwrap();
        }
        for (bad, part) in [
            (phong(1.0, -1.0), "exponent"),
            (phong(1.0, 1.1e5), "exponent"),
            (phong(1.0, f32::NAN), "exponent"),
            (phong(-0.1, 1.0), "specular"),
            (phong(f32::INFINITY, 1.0), "specular"),
            (modified(0.41, 1.0), "albedo"),
            (modified(f32::NAN, 1.0), "specular"),
            (modified(0.1, f32::INFINITY), "exponent"),
            (lafortune(1.0, 1.01, 1e5), "axis"),
            (lafortune(1.0, f32::NAN, 1.0), "axis"),
            (lafortune(-1.0, 1.0, 1.0), "scale"),
            (lafortune(1.0, 1.0, -1.0), "exponent"),
            (Reflectance::Lafortune { lobes: vec![] }, "lobes"),
        ] {
            let error = bad.validate(albedo).unwrap_err().to_string();
            assert!(error.contains(part), "{bad:?}: {error}");
        }
    }
}
