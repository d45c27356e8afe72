//! Intervals of error figures: where each lies, with a probability of 95 %, over the whole of which the receivers are a part.
//!
//! Receivers count as drawn at random, each with its weight, from all points that could have been scored. What a bootstrap
//! over them finds by drawing them anew is told here in closed form, from what each receiver adds to a figure. The truth's noise
//! is independent from receiver to receiver, so that it is in their spread already: an interval holds it, and adding it once
//! more would count it twice. Channels of a receiver stay together. With p a receiver's share of the weight, f its mean over
//! channels, and n = 1/Σp² receivers that would count alike:
//!
//! - means m = Σ p f (bias, mae; of e² − s² for the RMSE): a receiver adds u = p (f − m), `σ² = Σu² n/(n − 1)`, and
//!   `m − σ T(±t)`, with `T(t) = 3/g [∛(1 + g (t − g/6)) − 1]`, g = Σu³/(Σu²)^1.5, which takes the skewness off \[Hall1992\]: squares of
//!   errors are skewed, and a plain bootstrap's intervals of their means hold 74 to 94 % instead of 95 %. t is of Student's
//!   distribution with `2/(κ − 1/n)` degrees of freedom, κ = Σu⁴/(Σu²)², n − 1 at most: heavy tails make σ itself uncertain;
//! - the relative RMSE is a ratio, whose unit is a mean over the same receivers: to m/Ū², with Ū the mean of the unshadowed
//!   radiance U, a receiver adds `[u − 2 (m/Ū) p (U − Ū)] / Ū²`, to first order; in a class u has shares of the class, the rest of all;
//! - percentiles: the figures that so much more and less of the weight exceeds as a share can be off by \[Woodruff1952\], with
//!   half a receiver for whole numbers. None where the upper one lies beyond all receivers;
//! - shares of values below 0: the score interval \[Wilson1927\], with as many receivers as give the share its variance.
//!
//! A maximum has none: what was not met may be larger by anything.
//!
//! Neighbours err alike. Vertices and pixels cover surfaces more evenly than points at random do, so that for the surfaces of this scene
//! in this frame intervals are rather too wide than too narrow; of other scenes and views they say nothing.

#[cfg(test)]
mod coverage;

use crate::{
    errors::{Errors, tail_percentile},
    statistics::{NORMAL_95, student_two_sided},
};
use serde::{Deserialize, Serialize};

/// Receivers that would count alike from which on there are intervals: fewer may all have missed what errs.
const LEAST_RECEIVERS: f64 = 100.0;

/// 95 % intervals of figures, from the lower to the upper end, each in the figure's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intervals {
    /// Interval of `rmse`.
    pub rmse: [f64; 2],
    /// Interval of `rel_rmse`; the unit is taken as known where unshadowed radiance is not known receiver by receiver.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rel_rmse: Option<[f64; 2]>,
    /// Interval of `bias`.
    pub bias: [f64; 2],
    /// Interval of `mae`.
    pub mae: [f64; 2],
    /// Interval of `p95`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p95: Option<[f64; 2]>,
    /// Interval of `p99`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p99: Option<[f64; 2]>,
    /// Interval of `negative`.
    pub negative: [f64; 2],
}

/// Figures whose intervals are asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Figures {
    /// Mean of e² − s².
    pub(crate) mean_square: f64,
    pub(crate) bias: f64,
    pub(crate) mae: f64,
    pub(crate) p95: f64,
    pub(crate) p99: f64,
    pub(crate) negative: f64,
    /// Mean unshadowed radiance, where there is any.
    pub(crate) unit: Option<f64>,
}

impl Intervals {
    /// All intervals that there are, by name.
    pub fn all(self) -> impl Iterator<Item = (&'static str, [f64; 2])> {
        let Self { rmse, rel_rmse, bias, mae, p95, p99, negative } = self;
        let always = [("rmse", rmse), ("bias", bias), ("mae", mae), ("negative", negative)];
        let optional = [("rel_rmse", rel_rmse), ("p95", p95), ("p99", p99)];
        always.into_iter().chain(optional.into_iter().filter_map(|(name, interval)| Some((name, interval?))))
    }
}

/// Receivers beyond a percentile from which on it has an interval.
const LEAST_ABOVE: f64 = 4.0;

/// Fewest degrees of freedom that a variance is given.
const LEAST_DEGREES: f64 = 3.0;

/// Sums of powers of what receivers add to a figure.
#[derive(Clone, Copy, Default)]
struct Influences {
    squares: f64,
    cubes: f64,
    fourths: f64,
}

impl Influences {
    fn add(&mut self, influence: f64) {
        self.squares += influence * influence;
        self.cubes += influence.powi(3);
        self.fourths += influence.powi(4);
    }

    /// Interval of a `mean` over so many receivers that would count alike.
    fn interval(&self, mean: f64, receivers: f64) -> [f64; 2] {
        let deviation = (self.squares * receivers / (receivers - 1.0)).sqrt();
        let skewness = self.cubes / (self.squares * self.squares.sqrt());
        let straightened = |t: f64| match skewness.abs() > 1e-6 {
            true => 3.0 / skewness * ((1.0 + skewness * (t - skewness / 6.0)).cbrt() - 1.0),
            false => t,
        };
        let spread = (self.fourths.sqrt() / self.squares).powi(2) - 1.0 / receivers;
        let degrees = if spread > 0.0 { (2.0 / spread).min(receivers - 1.0) } else { receivers - 1.0 };
        let t = student_two_sided(degrees.max(LEAST_DEGREES));
        [t, -t].map(|t| mean - deviation * straightened(t))
    }

    /// Interval of a share, of which receivers that count differ more or less than if they counted alike; `most` of those.
    fn interval_of_share(&self, share: f64, most: f64) -> [f64; 2] {
        let variance = share * (1.0 - share);
        let count = if self.squares > 0.0 { variance / self.squares } else { most };
        let (z, z2) = (NORMAL_95, NORMAL_95 * NORMAL_95);
        let middle = (share + 0.5 * z2 / count) / (1.0 + z2 / count);
        let half = z / (1.0 + z2 / count) * (variance / count + 0.25 * z2 / (count * count)).sqrt();
        [(middle - half).max(0.0).min(share), (middle + half).min(1.0).max(share)]
    }

    /// Interval of the value that a share of 1 − `fraction` of the weight exceeds. `descending` are values with their weights,
    /// `total` the sum of these.
    fn interval_of_percentile(&self, descending: &[(f64, f64)], total: f64, fraction: f64) -> Option<[f64; 2]> {
        let above = 1.0 - fraction;
        let count = above * fraction / self.squares;
        if !count.is_finite() {
            // Everything has the same value.
            return tail_percentile(descending, total, fraction).map(|value| [value; 2]);
        }
        // The quantiles of a binomial distribution with its skewness, to first order.
        let skew = (NORMAL_95 * NORMAL_95 - 1.0) / 6.0 * (1.0 - 2.0 * above);
        let half = NORMAL_95 * (count * above * fraction).sqrt();
        let [fewest, most] = [count * above + skew - half - 0.5, count * above + skew + half + 0.5];
        let value = |exceeding: f64| tail_percentile(descending, total, 1.0 - exceeding / count);
        (fewest >= 0.0 && most < count).then_some(())?;
        Some([value(most)?, value(fewest)?])
    }
}

/// Intervals of `figures`, which are those of `errors`; `absolute` are the sizes of all errors from the largest on, with
/// their weights. `None` of too few receivers.
pub(crate) fn intervals(errors: &Errors<'_>, figures: &Figures, absolute: &[(f64, f64)]) -> Option<Intervals> {
    let total = errors.weights.total();
    let receivers = 1.0 / errors.counted().map(|(_, weight)| (weight / total).powi(2)).sum::<f64>();
    (receivers >= LEAST_RECEIVERS).then_some(())?;
    let mut parts = [Influences::default(); 6];
    for (i, weight) in errors.counted() {
        let e = errors.at(i);
        let mean = |of: &dyn Fn(f64) -> f64| e.iter().map(|e| of(*e)).sum::<f64>() / 3.0;
        let above = |limit: f64| mean(&|e| if e.abs() > limit { 1.0 } else { 0.0 });
        let deviations = [
            errors.square_at(i) - figures.mean_square,
            mean(&|e| e) - figures.bias,
            mean(&f64::abs) - figures.mae,
            above(figures.p95) - 0.05,
            above(figures.p99) - 0.01,
            errors.negative_at(i) - figures.negative,
        ];
        parts.iter_mut().zip(deviations).for_each(|(part, deviation)| part.add(weight / total * deviation));
    }
    let [square, bias, mae, p95, p99, negative] = parts;
    let root = |interval: [f64; 2]| interval.map(|end| end.max(0.0).sqrt());
    let percentile = |part: Influences, fraction: f64| {
        let is_known = receivers * (1.0 - fraction) >= LEAST_ABOVE;
        is_known.then(|| part.interval_of_percentile(absolute, 3.0 * total, fraction)).flatten()
    };
    Some(Intervals {
        rmse: root(square.interval(figures.mean_square, receivers)),
        rel_rmse: figures.unit.map(|unit| {
            let influences = relative_influences(errors, figures.mean_square, unit);
            root(influences.interval(figures.mean_square / (unit * unit), receivers))
        }),
        bias: bias.interval(figures.bias, receivers),
        mae: mae.interval(figures.mae, receivers).map(|end| end.max(0.0)),
        p95: percentile(p95, 0.95),
        p99: percentile(p99, 0.99),
        negative: negative.interval_of_share(figures.negative, receivers),
    })
}

/// Influences of receivers on the mean square in units of the square of `unit`, the mean unshadowed radiance over all receivers.
fn relative_influences(errors: &Errors<'_>, mean_square: f64, unit: f64) -> Influences {
    let (all, total) = (&errors.reference.weights, errors.weights.total());
    let mut influences = Influences::default();
    for (i, (weight, of_all)) in errors.weights.values().iter().zip(all.values()).enumerate() {
        let own = if *weight > 0.0 { weight / total * (errors.square_at(i) - mean_square) } else { 0.0 };
        let of_unit = errors.reference.unshadowed.get(i).map_or(0.0, |value| f64::from(*value) - unit);
        influences.add((own - 2.0 * mean_square / unit * (of_all / all.total()) * of_unit) / (unit * unit));
    }
    influences
}
