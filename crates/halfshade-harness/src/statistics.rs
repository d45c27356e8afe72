//! Median, median absolute deviation, percentiles: what survives a noisy machine.

use serde::{Deserialize, Serialize};

/// Middle and spread of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Median absolute deviation from the median, not scaled to a standard deviation.
    pub mad: f64,
}

impl Spread {
    /// Of `samples`; `None` without any.
    pub fn of(samples: &[f64]) -> Option<Self> {
        let median = median(samples)?;
        let deviations: Vec<f64> = samples.iter().map(|x| (x - median).abs()).collect();
        Some(Self { median, mad: self::median(&deviations)? })
    }
}

/// The middle value, or the mean of the two middle ones; `None` without samples.
pub fn median(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

/// The smallest value such that at least `fraction` of all are not above it (nearest rank); `sorted` rises.
pub fn percentile(sorted: &[f64], fraction: f64) -> Option<f64> {
    let rank = (fraction * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).or(sorted.last()).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_disturbed_sample_moves_neither_middle_nor_spread() {
        let calm = Spread::of(&[10.0, 11.0, 12.0, 13.0, 14.0]).unwrap();
        let disturbed = Spread::of(&[10.0, 11.0, 12.0, 13.0, 1e9]).unwrap();
        assert_eq!(calm, Spread { median: 12.0, mad: 1.0 });
        assert_eq!(disturbed, calm);
        assert_eq!(Spread::of(&[]), None);
    }

    #[test]
    fn even_counts_take_the_mean_of_the_middle() {
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
    }

    #[test]
    fn percentiles_by_nearest_rank() {
        let values: Vec<f64> = (1..=200).map(f64::from).collect();
        assert_eq!(percentile(&values, 0.95), Some(190.0));
        assert_eq!(percentile(&values, 0.99), Some(198.0));
        assert_eq!(percentile(&values, 1.0), Some(200.0));
        assert_eq!(percentile(&[3.0], 0.95), Some(3.0));
        assert_eq!(percentile(&[], 0.95), None);
    }
}
