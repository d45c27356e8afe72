//! The optimal-linear exponential: `exp(f) ≈ exp(f_0/sqrt(4π))·(a 1 + b f̂)` with a and b tabulated by `|f̂|`.

use crate::{zonal, zonal_algebra};
use std::f64::consts::{FRAC_PI_2, PI};

/// Magnitudes that a table covers at most; [Guerrero2007, 3.1.4] finds a and b to depend on the magnitude alone up to
/// here.
const LARGEST_MAGNITUDE: f64 = 4.8;

/// Intervals of the tables; linear interpolation between them errs by less than 1e-5.
const INTERVALS: usize = 256;

/// a and b by magnitude for one number of bands.
///
/// Least squares of the exponential onto 1 and f̂: `a = exp(f̂)·1/(1·1)`, `b = exp(f̂)·f̂/(f̂·f̂)` with **dot** products;
/// [Guerrero2007, eq. 3.29] prints SH products there. Built from the logarithms of single blockers, as
/// [Guerrero2007, 4.2] says.
///
/// Past [`limit`](Self::limit), a stays what it is there and b falls as `limit/|f̂|`, so that `b f̂` keeps its length:
/// continuous, finite and bounded, but no longer close to the exponential.
#[derive(Debug, Clone)]
pub struct OptimalLinear {
    step: f64,
    /// (a - 1, b) at multiples of `step`.
    entries: Vec<(f64, f64)>,
}

impl OptimalLinear {
    /// The table for `bands` bands from blockers whose logarithm clips eigenvalues at `clip`.
    ///
    /// It ends at magnitude 4.8, or where the logarithm of larger and larger blockers stops growing. With 1 band there
    /// is no f̂ and the table is empty.
    pub fn build(bands: usize, clip: f64) -> Self {
        let log_blocker = |radius: f64| zonal_algebra::logarithm_of_blocker(&zonal::cap(bands, radius.cos()), clip);
        let magnitude = |radius: f64| isolated_magnitude(&log_blocker(radius));
        let steps = 512;
        let radius_at = |i: usize| FRAC_PI_2 * i as f64 / steps as f64;
        let mut end = 0;
        let mut limit = 0.0;
        while end < steps && limit < LARGEST_MAGNITUDE {
            let next = magnitude(radius_at(end + 1));
            if next <= limit {
                break;
            }
            (end, limit) = (end + 1, next);
        }
        let limit = limit.min(LARGEST_MAGNITUDE);
        if limit == 0.0 {
            return Self { step: 1.0, entries: vec![(0.0, 1.0)] };
        }
        let step = limit / INTERVALS as f64;
        let mut entries = vec![(0.0, 1.0)];
        let mut low = 0.0;
        for entry in 1..=INTERVALS {
            let target = step * entry as f64;
            let mut high = radius_at(end);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if magnitude(middle) < target { low = middle } else { high = middle }
            }
            entries.push(fit(&log_blocker(0.5 * (low + high))));
        }
        Self { step, entries }
    }

    /// The magnitude at which the table ends.
    pub fn limit(&self) -> f64 {
        self.step * (self.entries.len() - 1) as f64
    }

    /// `(a - 1, b)` for an f̂ of this magnitude. a - 1 rather than a, because it is small where a result near 1 must
    /// stay accurate.
    pub fn coefficients(&self, magnitude: f64) -> (f64, f64) {
        let last = self.entries.len() - 1;
        let limit = self.limit();
        if last == 0 {
            return self.entries[0];
        }
        if magnitude >= limit {
            let (a, b) = self.entries[last];
            return (a, b * limit / magnitude);
        }
        let at = magnitude / self.step;
        let low = (at as usize).min(last - 1);
        let t = at - low as f64;
        let ((a0, b0), (a1, b1)) = (self.entries[low], self.entries[low + 1]);
        (a0 + t * (a1 - a0), b0 + t * (b1 - b0))
    }
}

impl OptimalLinear {
    /// (a - 1, b) at equally spaced magnitudes from 0 to the limit.
    pub(crate) fn entries(&self) -> &[(f64, f64)] {
        &self.entries
    }
}

/// `|f̂|`: the magnitude without the constant coefficient.
fn isolated_magnitude(zonal: &[f64]) -> f64 {
    zonal.iter().skip(1).map(|g| g * g).sum::<f64>().sqrt()
}

/// (a - 1, b) of one zonal logarithm.
fn fit(log: &[f64]) -> (f64, f64) {
    let mut isolated = log.to_vec();
    isolated[0] = 0.0;
    let exponential = zonal_algebra::exponential(&isolated);
    let dot: f64 = exponential.iter().zip(&isolated).map(|(e, f)| e * f).sum();
    let square: f64 = isolated.iter().map(|f| f * f).sum();
    (exponential[0] / (4.0 * PI).sqrt() - 1.0, dot / square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logarithm::DEFAULT_CLIP;

    #[test]
    fn starts_as_the_identity_and_is_continuous_past_its_end() {
        for bands in 1..=8 {
            let table = OptimalLinear::build(bands, DEFAULT_CLIP);
            assert_eq!(table.coefficients(0.0), (0.0, 1.0));
            let (a, b) = table.coefficients(1e-3);
            assert!(a.abs() < 1e-4 && (b - 1.0).abs() < 1e-2, "{bands}: {a} {b}");
            let limit = table.limit();
            assert!(bands == 1 || limit > 0.5, "{bands}: {limit}");
            let (before, after) = (table.coefficients(limit * (1.0 - 1e-9)), table.coefficients(limit * (1.0 + 1e-9)));
            assert!((before.0 - after.0).abs() < 1e-6 && (before.1 - after.1).abs() < 1e-6);
            let (_, far) = table.coefficients(1e6);
            assert!(bands == 1 || (far * 1e6 - after.1 * limit).abs() < 1e-6);
        }
    }

    #[test]
    fn mean_of_the_exponential_grows_with_the_magnitude() {
        // By Jensen the mean of exp(f̂) is at least 1 for an f̂ of mean 0; to second order it is 1 + |f̂|²/8π.
        let table = OptimalLinear::build(4, DEFAULT_CLIP);
        let (a, _) = table.coefficients(0.05);
        assert!((a / (0.05f64.powi(2) / (8.0 * PI)) - 1.0).abs() < 0.05, "{a}");
        assert!((1..=100).map(|i| table.coefficients(0.048 * i as f64).0).is_sorted());
    }
}
