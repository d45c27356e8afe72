//! The SH exponential of eight vectors at a time, the f32 twin of [`crate::exponential`].

use super::{ShBatch, product, square};
use crate::exponential::{Exponential, MAX_SQUARINGS, Method, SERIES_MAGNITUDE};
use wide::f32x8;

/// `sqrt(4π)`: the first coefficient of the function 1.
pub const FULL: f32 = 3.544_907_7;

/// An [`Exponential`] with its table in f32.
#[derive(Debug, Clone)]
pub struct BatchExponential {
    method: BatchMethod,
    table: LinearTable,
    bands: usize,
    blended: bool,
}

/// The parts of a [`BatchExponential`].
#[derive(Debug, Clone, Copy)]
pub struct ExponentialParts<'a> {
    /// Terms of the power series, if that is the inner form.
    pub series_terms: Option<u32>,
    /// Whether the optimal linear form is the inner form; if neither, the first two powers are.
    pub is_linear: bool,
    /// Magnitude at which squaring starts; infinite: never.
    pub magnitude_limit: f32,
    /// Whether one squaring more sets in without a jump.
    pub is_blended: bool,
    /// By magnitude (a - 1, b) of the optimal linear form, and their differences to the next entry.
    pub table: &'a [[f32; 4]],
    /// Magnitude of the last entry.
    pub table_limit: f32,
    /// Entries per magnitude.
    pub entries_per_magnitude: f32,
}

#[derive(Debug, Clone, Copy)]
enum BatchMethod {
    Series { terms: u32, magnitude_limit: f32 },
    Quadratic { magnitude_limit: f32 },
    Linear { magnitude_limit: f32 },
}

/// (a - 1, b) and their differences to the next entry.
#[derive(Debug, Clone)]
struct LinearTable {
    limit: f32,
    per_magnitude: f32,
    entries: Vec<[f32; 4]>,
}

impl LinearTable {
    /// (a - 1, b) by magnitude, as [`crate::optimal_linear::OptimalLinear::coefficients`].
    #[inline]
    fn coefficients(&self, magnitude: f32x8) -> (f32x8, f32x8) {
        let limit = f32x8::splat(self.limit);
        let at = magnitude.min(limit) * f32x8::splat(self.per_magnitude);
        let low = at.floor().min(f32x8::splat((self.entries.len() - 1) as f32));
        let t = at - low;
        let rows = low.trunc_int().to_array().map(|entry| self.entries[entry as usize]);
        let column = |c: usize| f32x8::from(rows.map(|row| row[c]));
        let a = column(2).mul_add(t, column(0));
        let b = column(3).mul_add(t, column(1));
        let past = magnitude.simd_gt(limit);
        (a, past.select(b * limit / magnitude.max(f32x8::splat(f32::MIN_POSITIVE)), b))
    }
}

impl BatchExponential {
    /// The f32 form of `exponential`, or `None` if it has more bands than the kernels.
    pub fn new(exponential: &Exponential) -> Option<Self> {
        if !(1..=super::MAX_BANDS).contains(&exponential.bands()) {
            return None;
        }
        let method = match exponential.method() {
            Method::Series { terms, magnitude_limit } => BatchMethod::Series {
                terms: terms.clamp(1, 16),
                magnitude_limit: magnitude_limit.map_or(f32::INFINITY, |limit| limit as f32),
            },
            Method::Quadratic { magnitude_limit } => BatchMethod::Quadratic { magnitude_limit: magnitude_limit as f32 },
            Method::OptimalLinear => BatchMethod::Linear { magnitude_limit: f32::INFINITY },
            Method::Hybrid { magnitude_limit } => BatchMethod::Linear { magnitude_limit: magnitude_limit as f32 },
        };
        let table = exponential.table();
        let limit = table.limit();
        let entries = table.entries();
        let table = LinearTable {
            limit: limit as f32,
            per_magnitude: if limit > 0.0 { ((entries.len() - 1) as f64 / limit) as f32 } else { 0.0 },
            entries: (0..entries.len())
                .map(|i| {
                    let ((a, b), next) = (entries[i], entries[(i + 1).min(entries.len() - 1)]);
                    [a as f32, b as f32, (next.0 - a) as f32, (next.1 - b) as f32]
                })
                .collect(),
        };
        Some(Self { method, table, bands: exponential.bands(), blended: exponential.is_blended() })
    }

    /// All that it knows, for kernels elsewhere.
    pub fn parts(&self) -> ExponentialParts<'_> {
        let (series_terms, is_linear) = match self.method {
            BatchMethod::Series { terms, .. } => (Some(terms), false),
            BatchMethod::Quadratic { .. } => (None, false),
            BatchMethod::Linear { .. } => (None, true),
        };
        ExponentialParts {
            series_terms,
            is_linear,
            magnitude_limit: self.magnitude_limit(),
            is_blended: self.blended,
            table: &self.table.entries,
            table_limit: self.table.limit,
            entries_per_magnitude: self.table.per_magnitude,
        }
    }

    /// Bands of the vectors it takes.
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// Visibility from sums of log blockers, as [`Exponential::evaluate`].
    ///
    /// Within 1e-5 of it relative to `sqrt(4π)` for magnitudes of tens, 1e-4 for thousands. A lane that needs fewer
    /// squarings than its neighbours keeps its value through theirs.
    ///
    /// # Panics
    /// If `N` is not `bands²`.
    pub fn evaluate<const N: usize>(&self, f: &ShBatch<N>) -> ShBatch<N> {
        assert_eq!(N, self.bands * self.bands, "one number of bands");
        let mut isolated = *f;
        let constant = std::mem::take(&mut isolated[0]) * f32x8::splat(1.0 / FULL);
        let magnitude = magnitude(&isolated);
        let limit = self.magnitude_limit();
        let (squarings, scale, most) = squarings(magnitude, limit);
        let mut h = self.scaled(&isolated, constant, magnitude, scale);
        if self.blended {
            let weight = (magnitude * scale).mul_add(f32x8::splat(2.0 / limit), -f32x8::ONE);
            let weight = weight.max(f32x8::ZERO).min(f32x8::ONE);
            if weight.simd_gt(f32x8::ZERO).any() {
                let half = self.scaled(&isolated, constant, magnitude, scale * f32x8::splat(0.5));
                let squared = square_difference(&half);
                h.iter_mut().zip(squared).for_each(|(h, s)| *h = weight.mul_add(s - *h, *h));
            }
        }
        for round in 0..most {
            let squared = square_difference(&h);
            let active = f32x8::splat(round as f32).simd_lt(squarings);
            h.iter_mut().zip(squared).for_each(|(h, s)| *h = active.select(s, *h));
        }
        h[0] += f32x8::splat(FULL);
        h
    }

    /// `weights · exp(f)`: what [`Self::evaluate`] and a dot product give, up to rounding.
    ///
    /// Where nothing has to be squared, the optimal-linear form is a sum of two vectors: their dot products do, and the
    /// vector of the result is never made. Lanes that are squared take the long way.
    ///
    /// # Panics
    /// If `N` is not `bands²`.
    pub fn evaluate_dot<const N: usize>(&self, f: &ShBatch<N>, weights: &ShBatch<N>) -> f32x8 {
        let BatchMethod::Linear { magnitude_limit } = self.method else {
            return dot(&self.evaluate(f), weights);
        };
        let mut isolated = *f;
        let constant = std::mem::take(&mut isolated[0]) * f32x8::splat(1.0 / FULL);
        let magnitude = magnitude(&isolated);
        let plain = magnitude.simd_le(f32x8::splat(if self.blended { 0.5 * magnitude_limit } else { magnitude_limit }));
        let long_way = if plain.all() { f32x8::ZERO } else { dot(&self.evaluate(f), weights) };
        let (a, b) = self.table.coefficients(magnitude);
        let difference = constant.exp_m1();
        let factor = difference + f32x8::ONE;
        let full = f32x8::splat(FULL);
        let h0 = (factor.mul_add(a, difference) * full).max(-full).min(f32x8::ZERO);
        let (room, scale) = (-h0 * (full + h0), b * factor);
        let energy = (scale * magnitude) * (scale * magnitude);
        let scale = energy.simd_gt(room).select(scale * (room / energy).sqrt(), scale);
        plain.select((h0 + full).mul_add(weights[0], scale * dot(&isolated, weights)), long_way)
    }

    fn magnitude_limit(&self) -> f32 {
        match self.method {
            BatchMethod::Series { magnitude_limit, .. }
            | BatchMethod::Quadratic { magnitude_limit }
            | BatchMethod::Linear { magnitude_limit } => magnitude_limit,
        }
    }

    /// The inner form of `scale` times a vector, as the difference from 1.
    #[inline(always)]
    fn scaled<const N: usize>(
        &self,
        isolated: &ShBatch<N>,
        constant: f32x8,
        magnitude: f32x8,
        scale: f32x8,
    ) -> ShBatch<N> {
        let mut h = *isolated;
        let scaled = magnitude * scale;
        let mut offset = f32x8::ZERO;
        match self.method {
            BatchMethod::Series { .. } | BatchMethod::Quadratic { .. } => {
                let limit = f32x8::splat(SERIES_MAGNITUDE as f32);
                let shorten = scaled.simd_gt(limit).select(limit / scaled, f32x8::ONE) * scale;
                h.iter_mut().for_each(|value| *value *= shorten);
                h = if let BatchMethod::Series { terms, .. } = self.method { series(&h, terms) } else { quadratic(&h) };
            }
            BatchMethod::Linear { .. } => {
                let (a, b) = self.table.coefficients(scaled);
                offset = a;
                let b = b * scale;
                h.iter_mut().for_each(|value| *value *= b);
            }
        }
        let exponent = constant * scale;
        let difference = exponent.exp_m1();
        let factor = difference + f32x8::ONE;
        h.iter_mut().for_each(|value| *value *= factor);
        h[0] = factor.mul_add(offset, difference).mul_add(f32x8::splat(FULL), h[0]);
        limit_difference(&mut h);
        h
    }
}

#[inline(always)]
fn magnitude<const N: usize>(f: &ShBatch<N>) -> f32x8 {
    dot(f, f).sqrt()
}

/// `Σ a_i b_i` of eight pairs.
#[inline(always)]
pub fn dot<const N: usize>(a: &ShBatch<N>, b: &ShBatch<N>) -> f32x8 {
    a.iter().zip(b).fold(f32x8::ZERO, |sum, (a, b)| a.mul_add(*b, sum))
}

/// `V*V - 1` from `h = V - 1`, limited.
#[inline(always)]
fn square_difference<const N: usize>(h: &ShBatch<N>) -> ShBatch<N> {
    let mut squared = square(h);
    let two = f32x8::splat(2.0);
    squared.iter_mut().zip(h).for_each(|(s, &h)| *s = two.mul_add(h, *s));
    limit_difference(&mut squared);
    squared
}

/// Number of squarings p by lane, `2^-p`, and the largest p.
#[inline]
fn squarings(magnitude: f32x8, limit: f32) -> (f32x8, f32x8, u32) {
    let (half, limit) = (f32x8::splat(0.5), f32x8::splat(limit));
    let (mut scaled, mut p, mut scale, mut most) = (magnitude, f32x8::ZERO, f32x8::ONE, 0);
    while most < MAX_SQUARINGS {
        let over = scaled.simd_gt(limit);
        if !over.any() {
            break;
        }
        let factor = over.select(half, f32x8::ONE);
        (scaled, scale) = (scaled * factor, scale * factor);
        p += over.select(f32x8::ONE, f32x8::ZERO);
        most += 1;
    }
    (p, scale, most)
}

/// `f̂ + f̂*f̂/2 + ..` by Horner's scheme.
fn series<const N: usize>(isolated: &ShBatch<N>, terms: u32) -> ShBatch<N> {
    let mut sum = isolated.map(|value| value * f32x8::splat(1.0 / terms as f32));
    for k in (1..terms).rev() {
        let higher = product(isolated, &sum);
        let share = f32x8::splat(1.0 / k as f32);
        sum.iter_mut().zip(isolated.iter().zip(higher)).for_each(|(s, (&f, h))| *s = (f + h) * share);
    }
    sum
}

/// `f̂ + f̂*f̂/2`.
fn quadratic<const N: usize>(isolated: &ShBatch<N>) -> ShBatch<N> {
    let mut sum = square(isolated);
    sum.iter_mut().zip(isolated).for_each(|(s, &f)| *s = f32x8::splat(0.5).mul_add(*s, f));
    sum
}

/// The constraint of [`crate::exponential::limit_to_visibility`] on `h = V - 1`.
#[inline(always)]
fn limit_difference<const N: usize>(h: &mut ShBatch<N>) {
    let full = f32x8::splat(FULL);
    h[0] = h[0].max(-full).min(f32x8::ZERO);
    let room = -h[0] * (full + h[0]);
    let energy = h[1..].iter().fold(f32x8::ZERO, |sum, &value| value.mul_add(value, sum));
    let over = energy.simd_gt(room);
    // Most batches have nothing to shrink; multiplying by 1 would leave the same bits.
    if over.any() {
        let shrink = over.select((room / energy).sqrt(), f32x8::ONE);
        h[1..].iter_mut().for_each(|value| *value *= shrink);
    }
}

/// Holds eight visibilities to what functions with values in [0, 1] can be, as
/// [`crate::exponential::limit_to_visibility`]; for SH products of blockers.
pub fn limit_to_visibility<const N: usize>(visibility: &mut ShBatch<N>) {
    visibility[0] -= f32x8::splat(FULL);
    limit_difference(visibility);
    visibility[0] += f32x8::splat(FULL);
}
