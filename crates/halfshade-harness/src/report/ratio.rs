//! Ratios of paired figures with intervals.

use super::significant::significant;
use crate::{
    metrics::Metrics,
    statistics::{NORMAL_95, median, median_interval},
};

/// Probability that an interval holds the ratio.
const COVERAGE: f64 = 0.95;

/// A ratio, and how far its interval reaches to the side where it reaches farther, if there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    pub(super) value: f64,
    pub(super) half_width: Option<f64>,
}

impl Ratio {
    /// The median over rounds of the ratio of two times in the same round, in which a disturbance meets both, with the interval of the
    /// sign test, which asks nothing of the distribution. `None` without rounds that both were timed in.
    pub(super) fn of_times(first: &[f64], second: &[f64]) -> Option<Self> {
        let ratios: Vec<f64> = first.iter().zip(second).map(|(a, b)| a / b).filter(|ratio| ratio.is_finite()).collect();
        let value = median(&ratios)?;
        let half_width = median_interval(&ratios, COVERAGE).map(|[low, high]| (value - low).max(high - value));
        Some(Self { value, half_width })
    }

    /// The ratio of two errors of the same receivers, of which `value` is told: paired receiver by receiver where both know their errors
    /// without parts of them, else with the truth's noise alone, as if it were independent.
    pub(super) fn of_errors(value: f64, first: &Metrics, second: &Metrics) -> Self {
        let share = |m: &Metrics| m.rmse_noise / m.rmse;
        let relative = match (&first.rmse_without, &second.rmse_without) {
            (Some(a), Some(b)) => a.relative_half_width(b),
            _ => Some(NORMAL_95 * share(first).hypot(share(second))),
        };
        let is_told = |half: &f64| first.resolved && second.resolved && half.is_finite();
        Self { value, half_width: relative.map(|relative| relative * value).filter(is_told) }
    }

    /// The geometric mean of independent ratios; without an interval if one of them has none.
    pub(super) fn mean(ratios: &[Self]) -> Self {
        let count = ratios.len() as f64;
        let value = (ratios.iter().map(|ratio| ratio.value.ln()).sum::<f64>() / count).exp();
        let shares: Option<Vec<f64>> = ratios.iter().map(|ratio| Some(ratio.half_width? / ratio.value)).collect();
        let half = |shares: Vec<f64>| value * shares.iter().map(|share| share * share).sum::<f64>().sqrt() / count;
        Self { value, half_width: shares.map(half) }
    }
}

impl std::fmt::Display for Ratio {
    /// As many digits as the interval leaves meaning in.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.half_width {
            Some(half) if half > 0.0 && self.value > 0.0 => {
                let digits = (self.value / half).log10().floor().clamp(0.0, 2.0) as usize + 2;
                let digits = digits.min(3);
                write!(f, "{} ± {}", significant(self.value, digits), significant(half, 1))
            }
            _ => f.write_str(&significant(self.value, 2)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_end_where_the_interval_begins() {
        let text = |value, half_width| Ratio { value, half_width }.to_string();
        assert_eq!(text(31.4, Some(2.1)), "31.4 ± 2");
        assert_eq!(text(31.4, Some(21.0)), "31 ± 21");
        assert_eq!(text(0.0312, Some(0.0004)), "0.0312 ± 0.0004");
        assert_eq!(text(1.416, None), "1.4");
        assert_eq!(text(1.0, Some(0.0)), "1.0");
    }

    /// Rounds that a drifting, spiking machine slows down by up to ten times, both strategies of a round alike, and each by a little of its own.
    #[test]
    fn intervals_of_paired_times_hold_at_their_rate() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let (rounds, ratio) = (4000, 2.5);
        for count in [7, 15] {
            let (mut held, mut width) = (0, 0.0);
            for _ in 0..rounds {
                let (mut drift, mut times) = (1.0, [Vec::new(), Vec::new()]);
                for _ in 0..count {
                    drift *= 1.0 + 0.2 * (random.random::<f64>() - 0.4);
                    let spike = if random.random::<f64>() < 0.1 { 10.0 } else { 1.0 };
                    // Skewed, with the same distribution of both.
                    let mut own = || 1.0 - 0.05 * random.random::<f64>().ln();
                    [ratio, 1.0]
                        .into_iter()
                        .zip(&mut times)
                        .for_each(|(secs, times)| times.push(secs * drift * spike * own()));
                }
                let found = Ratio::of_times(&times[0], &times[1]).unwrap();
                held += usize::from((found.value - ratio).abs() <= found.half_width.unwrap());
                width += found.half_width.unwrap() / f64::from(rounds);
            }
            let share = held as f64 / f64::from(rounds);
            assert!((0.93..0.999).contains(&share), "{count} rounds: {share}");
            assert!(width < 0.2 * ratio, "{width}");
        }
    }

    #[test]
    fn a_mean_of_ratios_is_known_better_than_each() {
        let ratio = |value, half_width| Ratio { value, half_width };
        let mean = Ratio::mean(&[ratio(2.0, Some(0.2)), ratio(8.0, Some(0.8))]);
        assert!((mean.value - 4.0).abs() < 1e-12);
        assert!((mean.half_width.unwrap() - 0.4 / 2.0f64.sqrt()).abs() < 1e-12);
        assert_eq!(Ratio::mean(&[ratio(2.0, Some(0.2)), ratio(2.0, None)]).half_width, None);
    }
}
