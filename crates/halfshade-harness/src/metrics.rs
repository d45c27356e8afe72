//! Error of a strategy against the truth, over receivers.
//!
//! All metrics run over *values*: every colour channel of every receiver counts, by the receiver's weight (see
//! `weights.rs`). With e = strategy − truth and s the standard error of the truth's value:
//!
//! - `bias` = mean e, `mae` = mean |e|, `p95`, `p99`, `max` of |e|: as measured, the truth's noise included. A percentile is
//!   the smallest value that so much of the weight does not exceed;
//! - `rmse` = sqrt(max(0, mean e² − mean s²)): the truth's noise adds its variance to e² on average, and is taken off;
//! - `rel_rmse` = rmse / mean of the unshadowed radiance; not defined where that mean is 0 or below the smallest normal
//!   number of single precision, 1.2e-38;
//! - `*_noise`: one standard deviation of each figure under a new seed of the truth (see `noise.rs`);
//! - `intervals`: where each figure lies with 95 %, with receivers drawn anew and the truth's noise (see `intervals.rs`);
//! - `negative` is the share of the strategy's values below 0: ringing, which no light has;
//! - `resolved` is false where rmse is below the root mean square of s, or mean e² − mean s² within three of its own
//!   standard deviations of 0: the truth has too few samples to tell. Neither assumes normal errors.
//!
//! The correction assumes errors independent between receivers, as the truth's seeds make them.

use crate::{
    errors::{Errors, Reference, square, tail_percentile},
    intervals::{Figures, Intervals, intervals},
    left_out::LeftOut,
    noise::noise,
    weights::ReceiverWeights,
};
use halfshade_scene::RadianceBuffer;
use halfshade_truth::Hider;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Standard deviations that a mean square error must be away from 0 to be resolved.
const RESOLVING_SIGMAS: f64 = 3.0;

/// The metrics of one comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Root mean square error, corrected for the truth's noise, in radiance.
    pub rmse: f64,
    /// `rmse` by the mean unshadowed radiance; `None` where there is none.
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
    /// Standard deviations of the other figures; missing in results of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bias_noise: Option<f64>,
    /// Noise of `mae`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mae_noise: Option<f64>,
    /// Noise of `p95`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p95_noise: Option<f64>,
    /// Noise of `p99`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p99_noise: Option<f64>,
    /// Noise of `max`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_noise: Option<f64>,
    /// Share of the values that are below 0; missing in results of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub negative: Option<f64>,
    /// Whether the truth can tell this error from none.
    pub resolved: bool,
    /// 95 % intervals, of receivers drawn anew and of the truth's noise; missing of few receivers and in results of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
    /// `rmse` without each of as many groups of receivers, for ratios to others; missing of few receivers and of classes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rmse_without: Option<LeftOut>,
}

impl Metrics {
    /// All figures that there are, by name.
    pub fn figures(&self) -> Vec<(&'static str, f64)> {
        let Self { rmse, rel_rmse, bias, mae, p95, p99, max, rmse_noise, .. } = *self;
        let Self { bias_noise, mae_noise, p95_noise, p99_noise, max_noise, negative, .. } = *self;
        let optional = [
            ("rel_rmse", rel_rmse),
            ("bias_noise", bias_noise),
            ("mae_noise", mae_noise),
            ("p95_noise", p95_noise),
            ("p99_noise", p99_noise),
            ("max_noise", max_noise),
            ("negative", negative),
        ];
        let always = [
            ("rmse", rmse),
            ("bias", bias),
            ("mae", mae),
            ("p95", p95),
            ("p99", p99),
            ("max", max),
            ("rmse_noise", rmse_noise),
        ];
        always.into_iter().chain(optional.into_iter().filter_map(|(name, value)| Some((name, value?)))).collect()
    }
}

/// Mean over receivers, by weight, and channels.
pub fn mean(radiance: &RadianceBuffer, weights: &ReceiverWeights) -> f64 {
    weights.mean(|i| radiance.channels.iter().map(|channel| f64::from(channel[i])).sum::<f64>() / 3.0)
}

/// A fraction of the mean unshadowed radiance; `None` where there is none, or less than single precision holds.
pub fn relative(value: f64, unshadowed_mean: f64) -> Option<f64> {
    (unshadowed_mean >= f64::from(f32::MIN_POSITIVE)).then(|| value / unshadowed_mean)
}

/// Compares `radiance` with `reference`. `None` if there is nothing to compare, or the lengths differ.
pub fn compare(radiance: &RadianceBuffer, reference: &Reference) -> Option<Metrics> {
    let errors = Errors { radiance, reference, weights: &reference.weights };
    let metrics = compare_weighted(&errors)?;
    Some(Metrics { rmse_without: LeftOut::of(&errors), ..metrics })
}

/// The same over receivers of one class; `None` if there is none.
pub fn compare_class(radiance: &RadianceBuffer, reference: &Reference, class: Hider) -> Option<(f64, Metrics)> {
    let weights = reference.weights.only(|i| reference.hiders.get(i) == Some(&class))?;
    let metrics = compare_weighted(&Errors { radiance, reference, weights: &weights })?;
    Some((weights.total() / reference.weights.total(), metrics))
}

fn compare_weighted(errors: &Errors<'_>) -> Option<Metrics> {
    let Errors { radiance, reference, weights } = *errors;
    let lengths = [reference.radiance.len(), reference.standard_error.len(), weights.values().len()];
    if radiance.is_empty() || lengths.iter().any(|length| *length != radiance.len()) {
        return None;
    }
    let channels = |i: usize, of: fn(f64) -> f64| errors.at(i).map(of).iter().sum::<f64>() / 3.0;
    let noise_square = weights.mean(|i| square(&reference.standard_error, i));
    let mut absolute: Vec<(f64, f64)> =
        errors.counted().flat_map(|(i, weight)| errors.at(i).map(|e| (e.abs(), weight))).collect();
    absolute.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let total = 3.0 * weights.total();
    let figures = Figures {
        mean_square: weights.mean(|i| channels(i, |e| e * e)) - noise_square,
        bias: weights.mean(|i| channels(i, |e| e)),
        mae: weights.mean(|i| channels(i, f64::abs)),
        p95: tail_percentile(&absolute, total, 0.95)?,
        p99: tail_percentile(&absolute, total, 0.99)?,
        negative: weights.mean(|i| errors.negative_at(i)),
        unit: relative(1.0, reference.unshadowed_mean).map(|_| reference.unshadowed_mean),
    };
    let noise = noise(errors);
    let rmse = figures.mean_square.max(0.0).sqrt();
    Some(Metrics {
        rmse,
        rel_rmse: relative(rmse, reference.unshadowed_mean),
        bias: figures.bias,
        mae: figures.mae,
        p95: figures.p95,
        p99: figures.p99,
        max: absolute.first()?.0,
        // Near rmse = 0 the linear propagation breaks down: the fourth root of the variance bounds it there.
        rmse_noise: (noise.mean_square / (2.0 * rmse).max(f64::MIN_POSITIVE)).min(noise.mean_square.sqrt()),
        bias_noise: Some(noise.bias),
        mae_noise: Some(noise.mae),
        p95_noise: Some(noise.p95),
        p99_noise: Some(noise.p99),
        max_noise: Some(noise.max),
        negative: Some(figures.negative),
        resolved: rmse > 0.0
            && rmse >= noise_square.sqrt()
            && figures.mean_square >= RESOLVING_SIGMAS * noise.mean_square,
        intervals: intervals(errors, &figures, &absolute),
        rmse_without: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::sync::Arc;

    fn buffer(values: &[[f32; 3]]) -> RadianceBuffer {
        RadianceBuffer { channels: std::array::from_fn(|c| values.iter().map(|v| v[c]).collect()) }
    }

    fn equal(count: usize) -> Arc<ReceiverWeights> {
        Arc::new(ReceiverWeights::equal(count))
    }

    /// Deterministic, nearly normal: the sum of 12 uniform numbers, minus 6.
    fn normals(count: usize, seed: u64) -> Vec<f64> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        (0..count).map(|_| (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0).collect()
    }

    /// Radiance 1 seen through noise that all channels share, with its draws.
    fn noisy(count: usize, noise: f64, seed: u64) -> Reference {
        let shared = |seed: u64| -> RadianceBuffer {
            let values = normals(count, seed);
            RadianceBuffer { channels: std::array::from_fn(|_| values.iter().map(|v| (noise * v) as f32).collect()) }
        };
        let mut radiance = shared(seed);
        radiance.channels.iter_mut().flatten().for_each(|value| *value += 1.0);
        Reference {
            standard_error: buffer(&vec![[noise as f32; 3]; count]),
            draws: (1..=8).map(|draw| shared(seed.wrapping_add(draw << 32))).collect(),
            ..Reference::exact(radiance, 1.0, equal(count))
        }
    }

    #[test]
    fn numbers_worked_out_by_hand() {
        // Errors 1, -2, 2, 0, 0, 3: mean 4/6, mean |e| 8/6, mean square 18/6.
        let truth = buffer(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        let reference = Reference::exact(truth, 2.0, equal(2));
        let m = compare(&buffer(&[[2.0, 0.0, 5.0], [4.0, 5.0, 9.0]]), &reference).unwrap();
        assert!((m.rmse - 3.0f64.sqrt()).abs() < 1e-12);
        assert!((m.rel_rmse.unwrap() - 3.0f64.sqrt() / 2.0).abs() < 1e-12);
        assert!((m.bias - 4.0 / 6.0).abs() < 1e-12 && (m.mae - 8.0 / 6.0).abs() < 1e-12);
        assert_eq!((m.p95, m.p99, m.max), (3.0, 3.0, 3.0));
        assert!(m.resolved && m.rmse_noise == 0.0 && m.max_noise == Some(0.0));
    }

    #[test]
    fn receivers_count_by_their_weights_and_classes_apart() {
        let truth = buffer(&[[0.0; 3]; 4]);
        let weights = equal(4).only(|i| i != 3).unwrap();
        let hiders = [Hider::Own, Hider::Ground, Hider::Ground, Hider::Own].into();
        let reference = Reference { hiders, ..Reference::exact(truth, 0.5, Arc::new(weights)) };
        let radiance = buffer(&[[1.0; 3], [2.0; 3], [4.0; 3], [100.0; 3]]);
        let m = compare(&radiance, &reference).unwrap();
        assert!((m.bias - 7.0 / 3.0).abs() < 1e-12 && m.max == 4.0 && (m.rmse - 7.0f64.sqrt()).abs() < 1e-12);
        let (share, own) = compare_class(&radiance, &reference, Hider::Own).unwrap();
        assert!((share - 1.0 / 3.0).abs() < 1e-12 && own.rmse == 1.0 && own.rel_rmse == Some(2.0));
        assert!(compare_class(&radiance, &reference, Hider::Other).is_none());
    }

    #[test]
    fn percentiles_are_nearest_ranks_of_the_weight() {
        let descending: Vec<(f64, f64)> = (1..=200).rev().map(|value| (f64::from(value), 1.0)).collect();
        let percentile = |fraction| tail_percentile(&descending, 200.0, fraction);
        assert_eq!((percentile(0.95), percentile(0.99)), (Some(190.0), Some(198.0)));
        assert_eq!(tail_percentile(&[(3.0, 0.2)], 0.2, 0.95), Some(3.0));
        assert_eq!(tail_percentile(&[], 0.0, 0.95), None);
        assert_eq!(tail_percentile(&[(9.0, 1.0), (5.0, 18.0), (1.0, 81.0)], 100.0, 0.99), Some(5.0));
    }

    #[test]
    fn relative_figures_need_light_that_single_precision_holds() {
        assert_eq!((relative(1.0, 0.0), relative(0.0, 0.0), relative(1e-42, 1e-42)), (None, None, None));
        assert_eq!((relative(1e-30, 1e-30), relative(f64::MAX, f64::NAN)), (Some(1.0), None));
    }

    #[test]
    fn the_noise_of_the_truth_is_taken_off_and_its_effect_predicted() {
        // A constant error of 0.02 seen through noise of 0.05 per value: uncorrected, the RMSE would read 0.054.
        let (count, error) = (4000, 0.02);
        let (mut squares, mut found, mut predicted) = (0.0, [const { Vec::new() }; 6], [0.0; 6]);
        for seed in 0..40 {
            let m = compare(&buffer(&vec![[1.0 + error as f32; 3]; count]), &noisy(count, 0.05, 77 + seed)).unwrap();
            assert!(!m.resolved, "0.02 lies below the truth's standard error of 0.05");
            squares += m.rmse * m.rmse / 40.0;
            let figures = [m.rmse, m.bias, m.mae, m.p95, m.p99, m.max];
            let noise = [Some(m.rmse_noise), m.bias_noise, m.mae_noise, m.p95_noise, m.p99_noise, m.max_noise];
            found.iter_mut().zip(figures).for_each(|(values, figure)| values.push(figure));
            predicted.iter_mut().zip(noise).for_each(|(sum, noise)| *sum += noise.unwrap() / 40.0);
        }
        assert!((squares.sqrt() / error - 1.0).abs() < 0.05, "{}", squares.sqrt());
        for (figure, (values, predicted)) in found.iter().zip(predicted).enumerate() {
            let mean = values.iter().sum::<f64>() / 40.0;
            let deviation = (values.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 39.0).sqrt();
            let ratio = deviation / predicted;
            // Where all receivers compete for the maximum by noise alone, it is claimed to be up to twice as uncertain as it is.
            assert!((0.5..1.4).contains(&ratio), "figure {figure}: {deviation} against {predicted}");
        }
    }

    #[test]
    fn pure_noise_is_not_resolved_and_a_clear_error_is() {
        let reference = noisy(3000, 1.0, 5);
        let exact = compare(&buffer(&vec![[1.0; 3]; 3000]), &reference).unwrap();
        assert!(!exact.resolved && exact.rmse < 0.3, "{exact:?}");
        assert!(compare(&buffer(&vec![[4.0; 3]; 3000]), &reference).unwrap().resolved);
    }

    #[test]
    fn what_two_references_have_in_common_is_no_noise_of_their_difference() {
        let reference = noisy(100, 0.1, 5);
        assert_eq!(reference.with_noise_of_difference(&reference).rms_standard_error(), 0.0);
        let other = reference.with_noise_of_difference(&noisy(100, 0.1, 6)).rms_standard_error();
        assert!((other / (0.1 * 2.0f64.sqrt()) - 1.0).abs() < 0.1, "{other}");
        let exact = Reference::exact(reference.radiance.clone(), 1.0, equal(100));
        for noise in [exact.with_noise_of_difference(&reference), reference.with_noise_of_difference(&exact)] {
            assert_eq!(noise.rms_standard_error(), reference.rms_standard_error());
        }
    }

    #[test]
    fn nothing_to_compare() {
        let reference = Reference::exact(buffer(&[]), 0.0, equal(0));
        assert_eq!(compare(&buffer(&[]), &reference), None);
        assert_eq!(compare(&buffer(&[[0.0; 3]]), &reference), None);
    }
}
