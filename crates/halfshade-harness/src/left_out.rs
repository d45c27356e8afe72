//! The RMSE with a part of the receivers left out, so that the errors of two strategies can be compared receiver by receiver when no
//! receiver is known any more.
//!
//! Receivers are dealt into sixteen groups by chance, every strategy's alike. Where receivers are hard for one strategy they are
//! hard for another, and the truth errs for all at once: what two RMSEs have in common cancels in their ratio, group by group. With
//! r_g the logarithm of the ratio without group g and r̄ the mean of all, the variance of the logarithm is
//! `(G − 1)/G Σ_g (r_g − r̄)²`, the grouped jackknife's [Efron1993, 11.5]; with so few groups Student's distribution with G − 1
//! degrees of freedom makes an interval of it.

use crate::{errors::Errors, noise::random, statistics::student_quantile};
use serde::{Deserialize, Serialize};

/// Number of groups: as many as the truth has estimates of its own, so that one quantile serves both.
const GROUPS: usize = 16;

/// Receivers for each group from which on groups are alike enough.
const LEAST_RECEIVERS: usize = 8;

/// A round of random numbers of its own.
const DEAL: u64 = 1 << 20;

/// RMSEs, corrected for the truth's noise, each without one of the groups of receivers; 0 where noise explains all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LeftOut([f64; GROUPS]);

impl LeftOut {
    /// Those of `errors`. `None` of too few receivers.
    pub(crate) fn of(errors: &Errors<'_>) -> Option<Self> {
        (errors.counted().count() >= GROUPS * LEAST_RECEIVERS).then_some(())?;
        let (mut weights, mut squares) = ([0.0; GROUPS], [0.0; GROUPS]);
        for (i, weight) in errors.counted() {
            let group = (random(DEAL, i as u64) >> 8) as usize % GROUPS;
            weights[group] += weight;
            squares[group] += weight * errors.square_at(i);
        }
        let (weight, square) = (weights.iter().sum::<f64>(), squares.iter().sum::<f64>());
        let without = |g: usize| ((square - squares[g]) / (weight - weights[g])).max(0.0).sqrt();
        let found = Self(std::array::from_fn(without));
        found.0.iter().all(|rmse| rmse.is_finite()).then_some(found)
    }

    /// Half the width of the 95 % interval of the ratio of two errors, as a share of the ratio. `None` where it is not known.
    pub(crate) fn relative_half_width(&self, other: &Self) -> Option<f64> {
        let count = GROUPS as f64;
        let logs: [f64; GROUPS] = std::array::from_fn(|g| (self.0[g] / other.0[g]).ln());
        let mean = logs.iter().sum::<f64>() / count;
        let variance = (count - 1.0) / count * logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        let half = student_quantile(0.025) * variance.sqrt();
        half.is_finite().then_some(half)
    }

    /// All of them.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_go_together_have_a_ratio_without_doubt() {
        let first = LeftOut(std::array::from_fn(|g| 1.0 + 0.1 * g as f64));
        let twice = LeftOut(first.0.map(|rmse| 2.0 * rmse));
        assert!(twice.relative_half_width(&first).unwrap() < 1e-12);
        // By hand: r is ±0.01, so that the variance is 15/16 · 16 · 1e-4.
        let other = LeftOut(std::array::from_fn(|g| first.0[g] * if g % 2 == 0 { 0.01f64 } else { -0.01 }.exp()));
        let half = first.relative_half_width(&other).unwrap();
        assert!((half / (2.1314 * 0.0015f64.sqrt()) - 1.0).abs() < 1e-4, "{half}");
        assert_eq!(first.relative_half_width(&LeftOut([0.0; GROUPS])), None);
    }
}
