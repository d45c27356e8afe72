//! Ratios with intervals.

use super::{super::significant::significant, contender::Contender};
use crate::statistics::{median, median_interval};

/// Probability that an interval holds the ratio.
pub(super) const COVERAGE: f64 = 0.95;

/// Standard deviations on either side of a normal estimate that make up [`COVERAGE`].
const SIGMAS: f64 = 1.96;

/// A ratio, and half the width of its interval where there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    pub(super) value: f64,
    pub(super) half_width: Option<f64>,
}

impl Ratio {
    /// How many times as fast as `baseline`: the median over rounds of the ratio of their times in the same round, in which a
    /// disturbance meets both, with the interval of the sign test, which asks nothing of the distribution.
    pub(super) fn of_speed(contender: &Contender<'_>, baseline: &Contender<'_>) -> Self {
        let rounds = baseline.rounds.iter().zip(&contender.rounds);
        let ratios: Vec<f64> = rounds.map(|(base, own)| base / own).filter(|ratio| ratio.is_finite()).collect();
        let half_width = median_interval(&ratios, COVERAGE).map(|[low, high]| 0.5 * (high - low));
        Self { value: median(&ratios).unwrap_or(baseline.frame_secs / contender.frame_secs), half_width }
    }

    /// How many times the error of `baseline`, with the truth's noise in both.
    pub(super) fn of_error(contender: &Contender<'_>, baseline: &Contender<'_>) -> Self {
        let value = contender.error / baseline.error;
        let share = |it: &Contender<'_>| it.error_noise / it.error;
        let half_width = SIGMAS * value * share(contender).hypot(share(baseline));
        let is_told = contender.resolved() && baseline.resolved() && half_width.is_finite();
        Self { value, half_width: is_told.then_some(half_width) }
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
}
