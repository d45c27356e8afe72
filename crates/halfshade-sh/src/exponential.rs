//! The SH exponential in f64: what turns a sum of log blockers into visibility.
//!
//! All forms isolate the constant coefficient: `exp(f) = exp(f_0/sqrt(4π))·exp(f̂)` [Guerrero2007, eq. 3.27].
//! Internally the result is carried as its difference `h` from the constant 1, because `(1 + h)*(1 + h) - 1 = 2h + h*h`
//! keeps its relative accuracy through any number of squarings, where squaring values near 1 would double the
//! rounding error each time.

use crate::basis;
use crate::optimal_linear::OptimalLinear;
use crate::product::{product, product_matrix, square};
use nalgebra::{DVector, SymmetricEigen};
use std::f64::consts::PI;

/// Squarings at most: enough for a magnitude of 4e6 at a limit of 0.25. Past it the scaled f̂ exceeds the limit, and
/// the inner form answers as it does for large magnitudes.
pub const MAX_SQUARINGS: u32 = 24;

/// Magnitude to which the bare series shortens f̂: what a series of 16 terms can take without overflow in f32.
pub const SERIES_MAGNITUDE: f64 = 64.0;

/// How to evaluate the exponential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// `1 + f̂ + f̂*f̂/2 + ..` up to the power `terms` [Guerrero2007, eq. 3.25].
    Series {
        /// Highest power; 1 to 16, anything else is brought into that range.
        terms: u32,
        /// With a limit, f is first scaled by 2^-p until `|f̂|` is below it, and squared p times. Without one the
        /// series diverges for many blockers; f̂ is then shortened to [`SERIES_MAGNITUDE`].
        magnitude_limit: Option<f64>,
    },
    /// `a 1 + b f̂` [Guerrero2007, eq. 3.30]: cheap, wrong past a magnitude of 4.8 or less.
    OptimalLinear,
    /// `1 + f̂ + f̂*f̂/2` of `f/2^p`, squared p times. Not a published form: the optimal-linear table is fitted to single
    /// blockers, whose f̂ is more skewed than a sum of many, and so errs towards too bright; one square more answers
    /// for the sum at hand. At a limit of 1 its error is that of the whole series for one squaring fewer than the
    /// hybrid at 0.25 (`examples/cap_experiment.rs`).
    Quadratic {
        /// As for the hybrid; 1 is a good value.
        magnitude_limit: f64,
    },
    /// Optimal-linear of `f/2^p`, squared p times [Guerrero2007, eq. 3.32].
    Hybrid {
        /// p is the least with `|f̂|/2^p` at or below this, at most [`MAX_SQUARINGS`].
        magnitude_limit: f64,
    },
}

/// An exponential made ready for one number of bands: table and method.
#[derive(Debug, Clone)]
pub struct Exponential {
    bands: usize,
    method: Method,
    table: OptimalLinear,
    blended: bool,
}

impl Exponential {
    /// `method` for `bands` bands and logarithms clipped at `clip`, usually [`crate::logarithm::DEFAULT_CLIP`].
    pub fn new(bands: usize, method: Method, clip: f64) -> Self {
        Self { bands, method, table: OptimalLinear::build(bands, clip), blended: false }
    }

    /// The same, with scaling made continuous. Not published: where |f̂| passes the magnitude limit times a power of two,
    /// the number of squarings grows by one, and the result jumps by the inner form's error. Blended, a vector on its way
    /// to the limit mixes in, more and more, the square of the inner form of half of it, up to all at the limit itself:
    ///
    /// ```text
    /// exp(f/2^p) ≈ (1 - w) inner(f/2^p) + w inner(f/2^(p+1))²     w = 2 |f̂|/2^p/limit - 1, in [0, 1]
    /// ```
    ///
    /// at the price of one squaring. Nothing changes without a limit.
    pub fn blended(self) -> Self {
        Self { blended: true, ..self }
    }

    /// Whether it is [`blended`](Self::blended).
    pub fn is_blended(&self) -> bool {
        self.blended
    }

    /// Bands of the vectors it takes.
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.method
    }

    /// The a/b table.
    pub fn table(&self) -> &OptimalLinear {
        &self.table
    }

    /// Visibility from the sum `f` of log blockers.
    ///
    /// The result is held to what a function with values in [0, 1] can be, see [`limit_to_visibility`], after each
    /// squaring and at the end. Without that the squarings can run away once ringing exceeds 1. Where the sum is
    /// accurate this changes nothing.
    ///
    /// # Panics
    /// If `f` has another number of bands.
    pub fn evaluate(&self, f: &[f64]) -> Vec<f64> {
        assert_eq!(f.len(), basis::coefficient_count(self.bands), "one number of bands");
        let mut isolated = f.to_vec();
        let constant = std::mem::take(&mut isolated[0]) / (4.0 * PI).sqrt();
        let magnitude = basis::magnitude(&isolated);
        let limit = match self.method {
            Method::Series { magnitude_limit, .. } => magnitude_limit,
            Method::Quadratic { magnitude_limit } | Method::Hybrid { magnitude_limit } => Some(magnitude_limit),
            Method::OptimalLinear => None,
        };
        let squarings = limit.map_or(0, |limit| squarings(magnitude, limit));
        let scale = 0.5f64.powi(squarings as i32);
        let mut h = self.scaled(&isolated, constant * scale, magnitude, scale);
        let weight = limit.map_or(0.0, |limit| (2.0 * magnitude * scale / limit - 1.0).clamp(0.0, 1.0));
        if self.blended && weight > 0.0 {
            let mut half = self.scaled(&isolated, constant * scale * 0.5, magnitude, scale * 0.5);
            square_difference(&mut half);
            h.iter_mut().zip(half).for_each(|(h, half)| *h += weight * (half - *h));
        }
        (0..squarings).for_each(|_| square_difference(&mut h));
        h[0] += (4.0 * PI).sqrt();
        h
    }

    /// The inner form of `scale` times a vector whose isolated part, unscaled, is given: as the difference from 1.
    fn scaled(&self, isolated: &[f64], constant: f64, magnitude: f64, scale: f64) -> Vec<f64> {
        let mut isolated: Vec<f64> = isolated.iter().map(|value| value * scale).collect();
        let (offset, difference) = match self.method {
            Method::Series { .. } | Method::Quadratic { .. } => {
                let terms = if let Method::Series { terms, .. } = self.method { terms } else { 2 };
                let shorten = (SERIES_MAGNITUDE / (magnitude * scale)).min(1.0);
                isolated.iter_mut().for_each(|value| *value *= shorten);
                (0.0, series(&isolated, terms))
            }
            Method::OptimalLinear | Method::Hybrid { .. } => {
                let (a, b) = self.table.coefficients(magnitude * scale);
                isolated.iter_mut().for_each(|value| *value *= b);
                (a, isolated)
            }
        };
        // e^d (1 + offset + difference) - 1, with d = constant
        let factor = constant.exp();
        let mut h: Vec<f64> = difference.iter().map(|value| factor * value).collect();
        h[0] += (4.0 * PI).sqrt() * (constant.exp_m1() + factor * offset);
        limit_difference(&mut h);
        h
    }
}

/// `V*V - 1` from `h = V - 1`, limited.
fn square_difference(h: &mut [f64]) {
    let squared = square(h);
    h.iter_mut().zip(squared).for_each(|(h, s)| *h = 2.0 * *h + s);
    limit_difference(h);
}

/// Least p with `magnitude/2^p <= limit`, at most [`MAX_SQUARINGS`].
pub fn squarings(magnitude: f64, limit: f64) -> u32 {
    let mut p = 0;
    let mut scaled = magnitude;
    while scaled > limit && p < MAX_SQUARINGS {
        (p, scaled) = (p + 1, scaled * 0.5);
    }
    p
}

/// `f̂ + f̂*f̂/2 + ..` by Horner's scheme.
fn series(isolated: &[f64], terms: u32) -> Vec<f64> {
    let mut sum = vec![0.0; isolated.len()];
    for k in (1..=terms.clamp(1, 16)).rev() {
        let higher = product(isolated, &sum);
        sum.iter_mut().zip(isolated.iter().zip(higher)).for_each(|(s, (f, h))| *s = (f + h) / f64::from(k));
    }
    sum
}

/// The whole series `Σ f^k/k!` with `f^k = M_f^{k-1} f`, by eigenanalysis: `exp(M_f) 1` [Guerrero2007, eq. 3.33].
///
/// Without truncation of the series and without limits: the reference for the other forms at moderate magnitudes.
///
/// # Panics
/// If the length of `f` is no square.
pub fn full_series(f: &[f64]) -> Vec<f64> {
    let bands = basis::bands_of(f.len()).expect("an SH vector has bands² coefficients");
    let eigen = SymmetricEigen::new(product_matrix(f));
    let mut rotated = eigen.eigenvectors.tr_mul(&DVector::from_vec(basis::one(bands)));
    rotated.iter_mut().zip(eigen.eigenvalues.iter()).for_each(|(value, x)| *value *= x.exp());
    (eigen.eigenvectors * rotated).as_slice().to_vec()
}

/// Holds an SH vector to what a function with values in [0, 1] can be.
///
/// For such a function `∫ V² <= ∫ V`, hence `|V|² <= sqrt(4π) V_0`, with or without truncation. V_0 is clamped to
/// `[0, sqrt(4π)]`, and if the inequality still fails the other coefficients are scaled down until it holds. So
/// `|V| <= sqrt(4π)`, and the squarings of the exponential, whose V_0 is `|V|²/sqrt(4π)`, can't grow.
pub fn limit_to_visibility(visibility: &mut [f64]) {
    let full = (4.0 * PI).sqrt();
    visibility[0] -= full;
    limit_difference(visibility);
    visibility[0] += full;
}

/// [`limit_to_visibility`] for `h = V - 1`, free of cancellation: `Σ_{i>0} h_i² <= -h_0 (sqrt(4π) + h_0)`.
fn limit_difference(h: &mut [f64]) {
    let full = (4.0 * PI).sqrt();
    h[0] = h[0].clamp(-full, 0.0);
    let room = -h[0] * (full + h[0]);
    let energy: f64 = h[1..].iter().map(|value| value * value).sum();
    if energy > room {
        let shrink = (room / energy).sqrt();
        h[1..].iter_mut().for_each(|value| *value *= shrink);
    }
}

/// SH products of blockers one after another [Guerrero2007, eq. 4.6], each result held to what a visibility can be.
pub fn product_of_blockers<'a>(bands: usize, blockers: impl IntoIterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut visibility = basis::one(bands);
    for blocker in blockers {
        visibility = product(&visibility, blocker);
        limit_to_visibility(&mut visibility);
    }
    visibility
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logarithm::DEFAULT_CLIP;
    use crate::{zonal, zonal_algebra};

    fn logarithm_of_blocker(blocker: &[f64]) -> Vec<f64> {
        crate::logarithm::logarithm(blocker, DEFAULT_CLIP)
    }

    fn round_trip_error(bands: usize, radius: f64) -> f64 {
        let blocker = zonal::to_spherical(&zonal::blocker(bands, radius.cos()));
        let back = full_series(&logarithm_of_blocker(&blocker));
        let difference: Vec<f64> = back.iter().zip(&blocker).map(|(a, b)| a - b).collect();
        basis::magnitude(&difference) / basis::magnitude(&blocker)
    }

    #[test]
    fn full_series_after_logarithm_returns_the_blocker_as_far_as_the_algebra_lets_it() {
        let table = [
            (0.2, [5e-9, 3e-8, 5e-7, 3e-6]),
            (0.4, [9e-7, 5e-6, 2e-5, 7e-4]),
            (0.8, [1e-5, 1e-3, 3e-2, 9e-3]),
            (1.2, [2e-2, 5e-2, 3e-2, 1e-2]),
        ];
        for (radius, expected) in table {
            for (bands, expected) in [3, 4, 6, 8].into_iter().zip(expected) {
                let error = round_trip_error(bands, radius);
                let ratio = error / expected;
                assert!((0.45..2.2).contains(&ratio), "radius {radius} bands {bands}: {error} against {expected}");
            }
        }
    }

    #[test]
    fn long_series_with_scaling_is_the_full_series() {
        let log: Vec<f64> = zonal::rotate_to_axis(
            &zonal::from_spherical(&logarithm_of_blocker(&zonal::to_spherical(&zonal::blocker(4, 0.6f64.cos())))),
            [0.36, -0.48, 0.8],
        );
        let long =
            Exponential::new(4, Method::Series { terms: 16, magnitude_limit: None }, DEFAULT_CLIP).evaluate(&log);
        for (a, b) in long.iter().zip(full_series(&log)) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }

    #[test]
    fn a_constant_is_exponentiated_exactly_at_any_size() {
        for method in methods() {
            for bands in 1..=4 {
                let exponential = Exponential::new(bands, method, DEFAULT_CLIP);
                for value in [-1e-6, -0.5, -3.0, -1e6] {
                    let mut f = basis::one(bands);
                    f[0] *= value;
                    let result = exponential.evaluate(&f);
                    assert!((result[0] / (4.0 * PI).sqrt() - f64::exp(value)).abs() < 1e-14);
                }
            }
        }
    }

    /// Four blockers that overlap.
    fn overlapping(radius: f64) -> Vec<f64> {
        let log = crate::zonal_algebra::logarithm(&zonal::blocker(4, radius.cos()), DEFAULT_CLIP);
        let axes = [[0.0, 0.6, 0.8], [0.36, -0.48, 0.8], [-0.64, 0.48, 0.6], [0.0, 0.0, 1.0]];
        axes.iter().fold(vec![0.0; 16], |mut sum, &axis| {
            sum.iter_mut().zip(zonal::rotate_to_axis(&log, axis)).for_each(|(s, l)| *s += l);
            sum
        })
    }

    #[test]
    fn quadratic_is_nearer_to_the_series_than_the_hybrid_of_the_same_limit() {
        let irradiance = zonal::rotate_to_axis(&zonal::clamped_cosine(4), [0.0, 0.0, 1.0]);
        let fraction = |f: &[f64], method| {
            let visibility = Exponential::new(4, method, DEFAULT_CLIP).evaluate(f);
            basis::dot(&irradiance, &visibility) / PI
        };
        for radius in [0.1, 0.2, 0.3, 0.4, 0.5] {
            let sum = overlapping(radius);
            let expected = fraction(&sum, Method::Series { terms: 16, magnitude_limit: Some(1.0) });
            let quadratic = (fraction(&sum, Method::Quadratic { magnitude_limit: 1.0 }) - expected).abs();
            let hybrid = (fraction(&sum, Method::Hybrid { magnitude_limit: 1.0 }) - expected).abs();
            assert!(quadratic < 6e-3 && quadratic < hybrid, "{radius}: {quadratic} {hybrid}");
        }
    }

    fn methods() -> [Method; 7] {
        [
            Method::Quadratic { magnitude_limit: 1.0 },
            Method::Series { terms: 9, magnitude_limit: None },
            Method::Series { terms: 4, magnitude_limit: Some(1.0) },
            Method::OptimalLinear,
            Method::Hybrid { magnitude_limit: 0.25 },
            Method::Hybrid { magnitude_limit: 2.0 },
            Method::Hybrid { magnitude_limit: 4.8 },
        ]
    }

    #[test]
    fn single_blockers_come_back_from_the_hybrid() {
        let exponential = Exponential::new(4, Method::Hybrid { magnitude_limit: 0.25 }, DEFAULT_CLIP);
        let irradiance = zonal::rotate_to_axis(&zonal::clamped_cosine(4), [0.0, 0.6, 0.8]);
        for radius in [0.01, 0.1, 0.3, 0.6] {
            let blocker = zonal::to_spherical(&zonal::blocker(4, f64::cos(radius)));
            let visibility = exponential.evaluate(&logarithm_of_blocker(&blocker));
            let error = (basis::dot(&irradiance, &visibility) - basis::dot(&irradiance, &blocker)).abs() / PI;
            assert!(error < 4e-3, "{radius}: {error}");
        }
    }

    #[test]
    fn blending_takes_the_step_out_of_scaling() {
        let log = zonal::rotate_to_axis(
            &zonal_algebra::logarithm(&zonal::blocker(6, 0.5f64.cos()), DEFAULT_CLIP),
            [0.0, 0.6, 0.8],
        );
        for method in [Method::Hybrid { magnitude_limit: 0.7 }, Method::Quadratic { magnitude_limit: 0.7 }] {
            let length = basis::magnitude(&log[1..]);
            let step = |exponential: &Exponential, at: f64| {
                let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|side| {
                    let scaled: Vec<f64> = log.iter().map(|value| value * at * side / length).collect();
                    exponential.evaluate(&scaled)
                });
                below.iter().zip(above).map(|(b, a)| (b - a).abs()).fold(0.0, f64::max)
            };
            let published = Exponential::new(6, method, DEFAULT_CLIP);
            let blended = published.clone().blended();
            for border in [0.35, 0.7, 1.4, 2.8] {
                assert!(step(&blended, border) < 1e-7, "{method:?} at {border}");
                assert!(border < 0.5 || step(&published, border) > 1e-4, "{method:?} at {border}");
            }
        }
    }
}
