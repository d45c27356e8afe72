//! Error of a strategy against the truth, over receivers.
//!
//! All metrics run over *values*: every colour channel of every receiver counts once, receivers are not weighted by
//! area. With e = strategy − truth and s the standard error of the truth's value:
//!
//! - `bias` = mean e, `mae` = mean |e|, `p95`, `p99`, `max` of |e|: as measured, the truth's noise included;
//! - `rmse` = sqrt(max(0, mean e² − mean s²)): the truth's noise adds its variance to e² on average, and is taken off;
//! - `rel_rmse` = rmse / mean of the unshadowed radiance;
//! - `rmse_noise`: one standard deviation of `rmse` under a new seed of the truth, by error propagation:
//!   Var(mean e²) = Σ(4 d² s² + 2 s⁴) / n², where d² is estimated by e² − s², divided by (2·rmse)²;
//! - `resolved` is false where rmse is below the root mean square of s: the truth has too few samples to tell.
//!
//! The correction assumes errors independent between receivers, as the truth's seeds make them.

use crate::statistics::percentile;
use halfshade_scene::RadianceBuffer;
use serde::{Deserialize, Serialize};

/// The metrics of one comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Root mean square error, corrected for the truth's noise, in radiance.
    pub rmse: f64,
    /// `rmse` by the mean unshadowed radiance; `None` where that is 0.
    pub rel_rmse: Option<f64>,
    /// Mean signed error: positive is too bright.
    pub bias: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// 95th percentile of the absolute error.
    pub p95: f64,
    /// 99th percentile of the absolute error.
    pub p99: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Standard deviation of `rmse` under the truth's noise.
    pub rmse_noise: f64,
    /// Whether the truth can tell this error from none.
    pub resolved: bool,
}

/// What a strategy is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Radiance.
    pub radiance: RadianceBuffer,
    /// Standard error of each value; 0 where exact.
    pub standard_error: RadianceBuffer,
    /// Mean over receivers and channels of the radiance with every blocker taken away.
    pub unshadowed_mean: f64,
}

impl Reference {
    /// Root mean square of the standard error.
    pub fn rms_standard_error(&self) -> f64 {
        let values = || self.standard_error.channels.iter().flatten();
        (values().map(|&s| f64::from(s).powi(2)).sum::<f64>() / values().count().max(1) as f64).sqrt()
    }
}

/// Mean over receivers and channels.
pub fn mean(radiance: &RadianceBuffer) -> f64 {
    let count = (3 * radiance.len()).max(1);
    radiance.channels.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / count as f64
}

/// Compares `radiance` with `reference`. `None` if there is nothing to compare, or the lengths differ.
pub fn compare(radiance: &RadianceBuffer, reference: &Reference) -> Option<Metrics> {
    if radiance.is_empty()
        || radiance.len() != reference.radiance.len()
        || radiance.len() != reference.standard_error.len()
    {
        return None;
    }
    let triples = || {
        radiance
            .channels
            .iter()
            .flatten()
            .zip(reference.radiance.channels.iter().flatten())
            .zip(reference.standard_error.channels.iter().flatten())
            .map(|((&value, &truth), &error)| (f64::from(value) - f64::from(truth), f64::from(error)))
    };
    let n = 3.0 * radiance.len() as f64;
    let sum = |term: &dyn Fn(f64, f64) -> f64| triples().map(|(e, s)| term(e, s)).sum::<f64>();
    let mean_square = sum(&|e, _| e * e) / n;
    let noise_square = sum(&|_, s| s * s) / n;
    let rmse = (mean_square - noise_square).max(0.0).sqrt();
    let variance = sum(&|e, s| 4.0 * e * e * s * s - 2.0 * s.powi(4)).max(0.0) / (n * n);
    let mut absolute: Vec<f64> = triples().map(|(e, _)| e.abs()).collect();
    absolute.sort_by(f64::total_cmp);
    Some(Metrics {
        rmse,
        rel_rmse: (reference.unshadowed_mean > 0.0).then(|| rmse / reference.unshadowed_mean),
        bias: sum(&|e, _| e) / n,
        mae: absolute.iter().sum::<f64>() / n,
        p95: percentile(&absolute, 0.95)?,
        p99: percentile(&absolute, 0.99)?,
        max: *absolute.last()?,
        // Near rmse = 0 the linear propagation breaks down: the fourth root of the variance bounds it there.
        rmse_noise: (variance.sqrt() / (2.0 * rmse).max(f64::MIN_POSITIVE)).min(variance.sqrt().sqrt()),
        resolved: rmse >= noise_square.sqrt() && rmse > 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn buffer(values: &[[f32; 3]]) -> RadianceBuffer {
        RadianceBuffer { channels: std::array::from_fn(|c| values.iter().map(|v| v[c]).collect()) }
    }

    /// Deterministic, nearly normal: the sum of 12 uniform numbers of a multiplicative generator, minus 6.
    fn normals(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn numbers_worked_out_by_hand() {
        // Errors 1, -2, 2, 0, 0, 3: mean 4/6, mean |e| 8/6, mean square 18/6.
        let reference = Reference {
            radiance: buffer(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
            standard_error: buffer(&[[0.0; 3]; 2]),
            unshadowed_mean: 2.0,
        };
        let m = compare(&buffer(&[[2.0, 0.0, 5.0], [4.0, 5.0, 9.0]]), &reference).unwrap();
        assert!((m.rmse - 3.0f64.sqrt()).abs() < 1e-12);
        assert!((m.rel_rmse.unwrap() - 3.0f64.sqrt() / 2.0).abs() < 1e-12);
        assert!((m.bias - 4.0 / 6.0).abs() < 1e-12 && (m.mae - 8.0 / 6.0).abs() < 1e-12);
        assert_eq!((m.p95, m.p99, m.max), (3.0, 3.0, 3.0));
        assert!(m.resolved && m.rmse_noise == 0.0);
    }

    #[test]
    fn the_noise_of_the_truth_is_taken_off_and_its_effect_predicted() {
        // A constant error of 0.02 seen through noise of 0.05 per value: uncorrected, the RMSE would read 0.054.
        let (count, noise, error) = (4000, 0.05, 0.02);
        let (mut squares, mut rmses, mut predicted) = (0.0, Vec::new(), 0.0);
        for seed in 0..40 {
            let draws = normals(3 * count, 77 + seed);
            let truth = RadianceBuffer {
                channels: std::array::from_fn(|c| {
                    (0..count).map(|i| (1.0 + noise * draws[3 * i + c]) as f32).collect()
                }),
            };
            let reference = Reference {
                radiance: truth,
                standard_error: buffer(&vec![[noise as f32; 3]; count]),
                unshadowed_mean: 1.0,
            };
            let m = compare(&buffer(&vec![[1.0 + error as f32; 3]; count]), &reference).unwrap();
            assert!(!m.resolved, "0.02 lies below the truth's standard error of 0.05");
            squares += m.rmse * m.rmse / 40.0;
            predicted += m.rmse_noise / 40.0;
            rmses.push(m.rmse);
        }
        assert!((squares.sqrt() / error - 1.0).abs() < 0.02, "{}", squares.sqrt());
        let mean = rmses.iter().sum::<f64>() / 40.0;
        let deviation = (rmses.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 39.0).sqrt();
        assert!((0.7..1.4).contains(&(deviation / predicted)), "{deviation} against {predicted}");
    }

    #[test]
    fn pure_noise_is_not_resolved_and_a_clear_error_is() {
        let count = 3000;
        let draws = normals(3 * count, 5);
        let noisy =
            RadianceBuffer { channels: std::array::from_fn(|c| (0..count).map(|i| draws[3 * i + c] as f32).collect()) };
        let reference =
            Reference { radiance: noisy, standard_error: buffer(&vec![[1.0; 3]; count]), unshadowed_mean: 1.0 };
        let exact = compare(&buffer(&vec![[0.0; 3]; count]), &reference).unwrap();
        assert!(!exact.resolved && exact.rmse < 0.2, "{exact:?}");
        assert!(compare(&buffer(&vec![[3.0; 3]; count]), &reference).unwrap().resolved);
    }

    #[test]
    fn nothing_to_compare() {
        let reference = Reference { radiance: buffer(&[]), standard_error: buffer(&[]), unshadowed_mean: 0.0 };
        assert_eq!(compare(&buffer(&[]), &reference), None);
        assert_eq!(compare(&buffer(&[[0.0; 3]]), &reference), None);
    }
}
