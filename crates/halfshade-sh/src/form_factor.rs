//! The average of a function on a sphere's surface as a receiver sees it [Guerrero2007, 4.3.3 "Average sphere radiance"].
//!
//! A sphere of angular radius θ, `s = sin θ`, carries an SH vector r over the directions from its centre. What a receiver
//! in direction ω from that centre sees of it on average is
//!
//! ```text
//! L̃ = Σ_l f_l Σ_m r_lm y_lm(ω)        f_l = ∫ w(α) P_l(cos α) sin α dα / ∫ w(α) sin α dα
//! ```
//!
//! over the part that faces the receiver, `cos α > s`: eq. 4.25, the rotation of a zonal vector spelled out. The weight w
//! is either of
//! - [`Weighting::Cosine`]: the cosine between the surface's normal and the receiver's direction, eq. 4.24, which in
//!   closed form is `(cos α - s)/√(1 + s² - 2 s cos α)`;
//! - [`Weighting::SolidAngle`]: that cosine over the squared distance, so that every direction of the receiver counts
//!   alike, as it does in the integral of incident radiance. The two agree for a far sphere; near one, the thesis's weight
//!   looks too far around it.

use crate::kernel::{LANES, MAX_BANDS};
use crate::quadrature::gauss_legendre;
use crate::{basis, zonal};
use std::f64::consts::FRAC_PI_2;
use wide::f32x8;

/// Weight of a point of the visible surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// Its cosine [Guerrero2007, eq. 4.24].
    Cosine,
    /// The solid angle that it takes at the receiver.
    SolidAngle,
}

/// `f_l` for `bands` bands and a sphere of `sin_radius` = sin θ in [0, 1]. `f_0` is 1; all are 1 where the receiver
/// touches the sphere.
///
/// Gauss-Legendre quadrature over the receiver's directions; error below 1e-9.
pub fn form_factor(bands: usize, sin_radius: f64, weighting: Weighting) -> Vec<f64> {
    integrated(&nodes(), bands, sin_radius, weighting)
}

fn nodes() -> Vec<(f64, f64)> {
    gauss_legendre(96, 0.0, FRAC_PI_2)
}

fn integrated(nodes: &[(f64, f64)], bands: usize, sin_radius: f64, weighting: Weighting) -> Vec<f64> {
    let s = sin_radius.clamp(0.0, 1.0);
    let (mut sums, mut total) = (vec![0.0; bands], 0.0);
    // A direction at angle β from the sphere's centre, sin β = s sin t, meets the surface at
    // cos α = s sin²t + cos t cos β, at the distance cos β - s cos t (in units of the centre's).
    for &(t, step) in nodes {
        let (sine, cosine) = t.sin_cos();
        let cos_beta = (1.0 - s * s * sine * sine).sqrt();
        let per_solid_angle = match weighting {
            Weighting::SolidAngle => 1.0,
            Weighting::Cosine => (cos_beta - s * cosine).powi(2),
        };
        let weight = step * per_solid_angle * sine * cosine / cos_beta;
        total += weight;
        let cos_alpha = (s * sine * sine + cosine * cos_beta).min(1.0);
        sums.iter_mut().zip(legendre(bands, cos_alpha)).for_each(|(sum, value)| *sum += weight * value);
    }
    if total > 0.0 { sums.iter().map(|sum| sum / total).collect() } else { vec![1.0; bands] }
}

/// `P_l(z)` by band.
fn legendre(bands: usize, z: f64) -> impl Iterator<Item = f64> {
    let values = basis::evaluate(bands, [(1.0 - z * z).max(0.0).sqrt(), 0.0, z]);
    (0..bands).map(move |l| values[l * (l + 1)] * zonal::rotation_scale(l))
}

/// Intervals of a table. Linear interpolation errs by less than 1e-4 up to sin θ = 0.95, by 5e-3 at 8 bands where the
/// receiver nearly touches the sphere.
pub const INTERVALS: usize = 256;

/// [`form_factor`] by sin θ, eight lookups at a time.
#[derive(Debug, Clone)]
pub struct FormFactorTable {
    /// Values of all bands at each end of an interval.
    rows: Box<[f32x8]>,
}

impl FormFactorTable {
    /// Tabulates all bands that there are kernels for: 8 KiB.
    pub fn build(weighting: Weighting) -> Self {
        let nodes = nodes();
        let row = |i: usize| {
            let values = integrated(&nodes, MAX_BANDS, i as f64 / INTERVALS as f64, weighting);
            f32x8::from(std::array::from_fn::<f32, LANES, _>(|l| values[l] as f32))
        };
        Self { rows: (0..=INTERVALS).map(row).collect() }
    }

    /// Values of all bands at each end of an interval, for kernels elsewhere.
    pub fn rows(&self) -> impl Iterator<Item = [f32; LANES]> {
        self.rows.iter().map(|row| row.to_array())
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
    }

    /// `f_l` by band for eight spheres of the given sines of angular radius, which are clamped to [0, 1] (NaN is 0).
    #[inline(always)]
    pub fn lookup(&self, sin_radius: f32x8) -> [f32x8; MAX_BANDS] {
        let at = sin_radius.max(f32x8::ZERO).min(f32x8::ONE) * f32x8::splat(INTERVALS as f32);
        let interval = at.floor().min(f32x8::splat((INTERVALS - 1) as f32));
        let t = (at - interval).to_array();
        let intervals = interval.trunc_int().to_array();
        f32x8::transpose(std::array::from_fn(|lane| {
            let (low, high) = (self.rows[intervals[lane] as usize], self.rows[intervals[lane] as usize + 1]);
            (high - low).mul_add(f32x8::splat(t[lane]), low)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight from eq. 4.24: midpoints in α, the arc tangent as printed.
    fn printed(bands: usize, s: f64) -> Vec<f64> {
        let steps = 200_000;
        let (mut sums, mut total) = (vec![0.0; bands], 0.0);
        for i in 0..steps {
            let alpha = std::f64::consts::PI * (f64::from(i) + 0.5) / f64::from(steps);
            let tangent = (1.0 - s * alpha.cos()) / (s * alpha.sin());
            let weight = (tangent.atan() - alpha).sin().max(0.0) * alpha.sin();
            total += weight;
            sums.iter_mut().zip(legendre(bands, alpha.cos())).for_each(|(sum, p)| *sum += weight * p);
        }
        sums.iter().map(|sum| sum / total).collect()
    }

    #[test]
    fn cosine_weights_are_those_of_the_thesis() {
        for s in [1e-3, 0.2, 0.5, 0.9, 0.999] {
            for (found, expected) in form_factor(6, s, Weighting::Cosine).iter().zip(printed(6, s)) {
                assert!((found - expected).abs() < 1e-6, "{s}: {found} {expected}");
            }
        }
    }

    /// Rays from a receiver, uniform in solid angle over the cap, meet a sphere that carries an arbitrary SH vector.
    #[test]
    fn solid_angle_weights_average_what_rays_see() {
        let radiance = [1.0, 0.3, -0.7, 0.4, 0.2, -0.1, 0.5, 0.3, -0.2, 0.6, 0.1, -0.3, 0.2, 0.4, -0.5, 0.1];
        for s in [0.1, 0.6, 0.95f64] {
            let receiver = [0.48, 0.64, 0.6];
            let expected = {
                let (rings, spokes) = (400, 64);
                let cos_theta = (1.0 - s * s).sqrt();
                let mut sum = 0.0;
                for ring in 0..rings {
                    let cosine = 1.0 - (1.0 - cos_theta) * (f64::from(ring) + 0.5) / f64::from(rings);
                    let sine = (1.0 - cosine * cosine).sqrt();
                    for spoke in 0..spokes {
                        let (sin, cos) = (std::f64::consts::TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
                        // Two axes across the receiver's direction.
                        let (u, v) = ([0.8, -0.6, 0.0], [0.36, 0.48, -0.8]);
                        let ray: [f64; 3] =
                            std::array::from_fn(|i| sine * (cos * u[i] + sin * v[i]) - cosine * receiver[i]);
                        let along = -basis_dot(ray, receiver);
                        let distance = along - (s * s - (1.0 - along * along)).max(0.0).sqrt();
                        let hit: [f64; 3] = std::array::from_fn(|i| (receiver[i] + distance * ray[i]) / s);
                        sum += basis::reconstruct(&radiance, hit);
                    }
                }
                sum / f64::from(rings * spokes)
            };
            let zonal: Vec<f64> = (form_factor(4, s, Weighting::SolidAngle).iter().enumerate())
                .map(|(l, f)| f / zonal::rotation_scale(l))
                .collect();
            let found = basis::dot(&radiance, &zonal::rotate_to_axis(&zonal, receiver));
            assert!((found - expected).abs() < 1e-4, "{s}: {found} {expected}");
        }
    }

    fn basis_dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    #[test]
    fn weightings_agree_far_away_and_see_one_point_on_touch() {
        for weighting in [Weighting::Cosine, Weighting::SolidAngle] {
            assert!((form_factor(3, 0.7, weighting)[0] - 1.0).abs() < 1e-12);
            assert!(form_factor(8, 1.0, weighting).iter().all(|f| (f - 1.0).abs() < 1e-12));
            // ∫ 2 cos²α sin α dα = 2/3.
            assert!((form_factor(2, 0.0, weighting)[1] - 2.0 / 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn lookups_are_close() {
        for weighting in [Weighting::Cosine, Weighting::SolidAngle] {
            let table = FormFactorTable::build(weighting);
            for i in 0..=1000 {
                let s = i as f32 / 1000.0;
                let expected = form_factor(MAX_BANDS, f64::from(s), weighting);
                for (found, expected) in table.lookup(f32x8::splat(s)).iter().zip(expected) {
                    let bound = if s < 0.95 { 1e-4 } else { 5e-3 };
                    assert!((f64::from(found.to_array()[5]) - expected).abs() < bound, "{s}: {found:?} {expected}");
                }
            }
            let limits = table.lookup(f32x8::from([f32::NAN, -1.0, 2.0, f32::INFINITY, 0.0, 1.0, 1e-30, 0.5]));
            assert!(limits.iter().flat_map(|value| value.to_array()).all(f32::is_finite));
        }
    }
}
