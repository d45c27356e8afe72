//! Directions about a normal, and the weights that make sums over them integrals of a cosine times SH.
//!
//! K directions with the density cos/π, a spiral of equal steps, would weigh 1/K each. Weights are changed by as little as
//! possible, in the least squares, so that the sum over all of them is exact:
//!
//! ```text
//! Σ_k w_k y_i(d_k) = 1/π ∫ y_i(ω) max(n·ω, 0) dω        for all i of n bands
//! ```
//!
//! The sum over open directions and the closed form less the sum over blocked ones are the same number then. A vertex that sees
//! everything gets the closed form to the last bit, one that sees nothing gets 0, and between them the error is that of the
//! boundary alone: the estimator of either kind would have that of the whole where most is blocked, or open. SH of n bands stay
//! such when they are turned, so that the weights hold about every normal.

use crate::shared::{cosine_spiral::cosine_spiral, split_mix::split_mix};
use glam::{DMat3, DVec3, Vec3};
use halfshade_sh::{basis, rotation::ShRotation, zonal};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Directions for each function that a sum is to be exact for, at least: with fewer, weights would stray far from each other.
const DIRECTIONS_PER_FUNCTION: usize = 16;

/// Directions about +Z.
#[derive(Debug)]
pub(crate) struct Hemisphere {
    bands: usize,
    /// Unit directions and their weights.
    directions: Vec<(DVec3, f64)>,
    /// Per direction, its weight times the basis.
    values: Vec<f64>,
    /// The sum over all directions about +Z, band by band.
    open: Vec<f64>,
}

impl Hemisphere {
    pub(crate) fn new(bands: usize, count: usize) -> Self {
        Self::weighted(bands, count, cosine(bands), |_| 1.0)
    }

    /// Directions for sums over `1/π passing(n·ω) max(n·ω, 0)` in place of the cosine.
    pub(crate) fn through(bands: usize, count: usize, passing: impl Fn(f64) -> f64) -> Self {
        Self::weighted(bands, count, passed(bands, &passing), passing)
    }

    fn weighted(bands: usize, count: usize, open: Vec<f64>, passing: impl Fn(f64) -> f64) -> Self {
        let spiral: Vec<DVec3> = cosine_spiral(count).collect();
        let exact = zonal::to_spherical(&open[..exact_bands(bands, count)]);
        let base: Vec<f64> = spiral.iter().map(|direction| passing(direction.z) / count as f64).collect();
        let weights = weights(&base, &exact, &spiral);
        let values = spiral.iter().zip(&weights).flat_map(|(direction, weight)| {
            let y = basis::evaluate(bands, direction.to_array());
            y.into_iter().map(move |value| weight * value)
        });
        Self { bands, values: values.collect(), directions: spiral.into_iter().zip(weights).collect(), open }
    }

    /// Number of directions.
    pub(crate) fn count(&self) -> usize {
        self.directions.len()
    }

    /// Numbers of a vector.
    pub(crate) fn coefficients(&self) -> usize {
        self.bands * self.bands
    }

    /// Unit direction k, about +Z.
    pub(crate) fn direction(&self, k: usize) -> DVec3 {
        self.directions[k].0
    }

    /// Its weight.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.directions[k].1
    }

    /// Transfer of a vertex that sees everything: `1/π ∫ y(ω) max(n·ω, 0) dω`, times what passes.
    pub(crate) fn open(&self, normal: Vec3) -> Vec<f64> {
        zonal::rotate_to_axis(&self.open, axis_of(normal).to_array())
    }

    /// The rotation that turns directions about +Z into directions about the normal of a vertex. It is turned about the normal
    /// by an angle that is hashed from both, so that neighbours err independently, and vertices in one place alike.
    pub(crate) fn frame(position: Vec3, normal: Vec3) -> DMat3 {
        let axis = axis_of(normal);
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let bits = position.to_array().into_iter().chain(normal.to_array());
        // Zeros of either sign are one place.
        let hash = bits.fold(0_u64, |hash, value| split_mix(hash ^ u64::from((value + 0.0).to_bits())));
        let (sin, cos) = ((hash >> 11) as f64 * (TAU / (1_u64 << 53) as f64)).sin_cos();
        DMat3::from_cols(cos * tangent + sin * bitangent, cos * bitangent - sin * tangent, axis)
    }

    /// `Σ w_k y(frame · d_k)` over those directions whose numbers are given.
    pub(crate) fn sum(&self, frame: &DMat3, numbers: impl Iterator<Item = usize>) -> Vec<f64> {
        let count = self.coefficients();
        let mut sum = vec![0.0; count];
        for k in numbers {
            sum.iter_mut().zip(&self.values[k * count..]).for_each(|(sum, value)| *sum += value);
        }
        // Rows of the rotation are the columns of its transpose.
        ShRotation::new(self.bands, &frame.transpose().to_cols_array_2d()).apply(&sum)
    }
}

/// Transfer about unit `axis` where nothing hides any light: the clamped cosine over π.
pub(crate) fn open_transfer(bands: usize, axis: DVec3) -> Vec<f64> {
    zonal::rotate_to_axis(&cosine(bands), axis.to_array())
}

/// The clamped cosine over π, band by band.
fn cosine(bands: usize) -> Vec<f64> {
    zonal::clamped_cosine(bands).into_iter().map(|value| value / PI).collect()
}

/// The same times what passes at each cosine, by the midpoint rule.
fn passed(bands: usize, passing: impl Fn(f64) -> f64) -> Vec<f64> {
    let steps = 4096;
    let mut sum = vec![0.0; bands];
    for k in 0..steps {
        let height = (f64::from(k) + 0.5) / f64::from(steps);
        let y = basis::evaluate(bands, [(1.0 - height * height).sqrt(), 0.0, height]);
        let share = 2.0 * height * passing(height) / f64::from(steps);
        sum.iter_mut().enumerate().for_each(|(l, sum)| *sum += share * y[basis::index(l, 0)]);
    }
    sum
}

/// A normal of unit length, whatever a mesh says.
fn axis_of(normal: Vec3) -> DVec3 {
    normal.as_dvec3().normalize_or(DVec3::Y)
}

/// Bands, at most so many, for which sums over directions can be exact.
pub(crate) fn exact_bands(bands: usize, directions: usize) -> usize {
    (1..=bands).rev().find(|b| b * b * DIRECTIONS_PER_FUNCTION <= directions).unwrap_or(1)
}

/// Weights near `base` with which sums over the directions are the SH vector `exact`.
pub(crate) fn weights(base: &[f64], exact: &[f64], directions: &[DVec3]) -> Vec<f64> {
    let bands = exact.len().isqrt();
    let columns: Vec<_> =
        directions.iter().map(|direction| DVector::from_vec(basis::evaluate(bands, direction.to_array()))).collect();
    let y = DMatrix::from_columns(&columns);
    let missing = DVector::from_column_slice(exact) - &y * DVector::from_column_slice(base);
    let mut weighted = y.clone();
    weighted.column_iter_mut().zip(base).for_each(|(mut column, base)| column *= *base);
    let gram = (&weighted * y.transpose()).svd(true, true);
    let least = 1e-12 * gram.singular_values.max();
    // Both factors were asked for.
    let change = gram.solve(&missing, least).unwrap_or_else(|_| DVector::zeros(missing.len()));
    base.iter().zip(weighted.tr_mul(&change).iter()).map(|(base, change)| base + change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NORMALS: [Vec3; 4] = [Vec3::Z, Vec3::NEG_Y, Vec3::new(0.6, -0.48, 0.64), Vec3::ZERO];

    #[test]
    fn all_directions_together_are_the_closed_form() {
        for (bands, count) in [(1, 16), (2, 64), (4, 256), (4, 1024), (8, 1024), (8, 4096)] {
            let hemisphere = Hemisphere::new(bands, count);
            let [least, most] = [f64::min, f64::max]
                .map(|pick| hemisphere.directions.iter().map(|(_, w)| w * count as f64).reduce(pick).unwrap());
            assert!(least > 0.2 && most < 2.0, "{bands} {count}: {least} {most}");
            for normal in NORMALS {
                let sum = hemisphere.sum(&Hemisphere::frame(Vec3::ONE, normal), 0..count);
                let open = hemisphere.open(normal);
                let worst = sum.iter().zip(&open).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-9, "{bands} {count} {normal}: {worst}");
            }
        }
    }

    /// Fresnel-like factors: all directions together are exact again, and a factor of 1 is the cosine.
    #[test]
    fn what_passes_is_summed_exactly() {
        let even = passed(6, |_| 1.0);
        assert!(even.iter().zip(cosine(6)).all(|(a, b)| (a - b).abs() < 1e-7), "{even:?}");
        for (bands, count) in [(3, 16), (4, 256), (6, 1024)] {
            let hemisphere = Hemisphere::through(bands, count, |cosine| cosine.sqrt());
            let normal = NORMALS[2];
            let sum = hemisphere.sum(&Hemisphere::frame(Vec3::ONE, normal), 0..count);
            let (exact, open) = (exact_bands(bands, count), hemisphere.open(normal));
            let worst = sum.iter().zip(&open).take(exact * exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{bands} {count}: {worst}");
            // ∫ 2 x^1.5 dx = 0.8 of the sky.
            assert!((open[0] * (4.0 * PI).sqrt() - 0.8).abs() < 1e-4);
        }
    }

    /// Half of the sky is half of its light, and a polynomial has its closed form about every normal.
    #[test]
    fn half_the_directions_are_half_the_sky() {
        let hemisphere = Hemisphere::new(4, 1024);
        for normal in NORMALS {
            let frame = Hemisphere::frame(Vec3::X, normal);
            let side = frame * DVec3::new(0.6, 0.8, 0.0);
            let half = (0..1024).filter(|&k| (frame * hemisphere.directions[k].0).dot(side) > 0.0);
            let sky = hemisphere.sum(&frame, half)[0] * (4.0 * PI).sqrt();
            assert!((sky - 0.5).abs() < 2e-3, "{normal}: {sky}");
        }
    }

    #[test]
    fn one_place_has_one_frame() {
        assert_eq!(Hemisphere::frame(Vec3::ZERO, Vec3::Y), Hemisphere::frame(-Vec3::ZERO, Vec3::new(-0.0, 1.0, 0.0)));
        assert_ne!(Hemisphere::frame(Vec3::ZERO, Vec3::Y), Hemisphere::frame(Vec3::X, Vec3::Y));
        for normal in NORMALS {
            let frame = Hemisphere::frame(Vec3::X, normal);
            assert!((frame * frame.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12) && frame.determinant() > 0.0);
            assert_eq!(frame.z_axis, axis_of(normal));
        }
    }
}
