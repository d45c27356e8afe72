//! How far the truth's noise moves each figure: one standard deviation under another seed of the truth.
//!
//! Receivers are independent, while the channels of a receiver share their rays and err together. Each receiver comes
//! with draws h of its noise (see `halfshade_truth::estimate`), which have its tails and its correlation between channels;
//! nothing below assumes that it is normal. With e = strategy − truth per channel, w a receiver's share of the weight, c
//! over channels and k over draws:
//!
//! - bias: `Var = Σ w² mean_k (mean_c h)²`;
//! - mean square M = Σ w mean_c (e² − s²): `Var = Σ w² [mean_k (⅔ Σ_c e h)² − 4/9 mean_{k<l} (h_k·h_l)² + Var_k(mean_c h²)]`;
//!   e itself is noisy, which is what the second term takes off. The RMSE's is `σ(M) / (2 rmse)`, at most `√σ(M)`, which
//!   bounds it near 0;
//! - mae: `Var = Σ w² Var_{k,±}(mean_c |e ± h|)`, the bootstrap's variance in closed form; up to √2 too large where errors
//!   are mere noise;
//! - p95, p99 and max: the standard deviation over [`ROUNDS`] rounds in which every receiver draws its noise anew, d ± h with
//!   a random k and sign. d is e shrunk by its noise, `e √max(0, 1 − s²/e²)`, so that noise isn't counted twice. Only values
//!   that can get among the largest take part.

use crate::errors::{Errors, tail_percentile};
use halfshade_truth::DRAWS;
use rayon::prelude::*;

/// Rounds of drawing noise; a standard deviation is then uncertain by 10 %.
const ROUNDS: usize = 50;

/// One standard deviation of each figure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Noise {
    pub(crate) mean_square: f64,
    pub(crate) bias: f64,
    pub(crate) mae: f64,
    pub(crate) p95: f64,
    pub(crate) p99: f64,
    pub(crate) max: f64,
}

/// A value that the noise may bring among the largest.
struct Candidate {
    receiver: u64,
    weight: f64,
    error: f64,
    draws: [f64; DRAWS],
}

/// Noise of the figures of `errors`. Without draws the truth is exact, or nobody asks.
pub(crate) fn noise(errors: &Errors<'_>) -> Noise {
    let draws = &errors.reference.draws;
    if draws.is_empty() {
        return Noise::default();
    }
    let count = draws.len() as f64;
    let total = errors.weights.total();
    let (mut bias, mut mae, mut mean_square) = (0.0, 0.0, 0.0);
    let mut h = vec![[0.0f64; 3]; draws.len()];
    for (i, weight) in errors.counted() {
        let e = errors.at(i);
        for (own, draw) in h.iter_mut().zip(draws) {
            *own = draw.at(i).to_array().map(f64::from);
        }
        if h.iter().flatten().all(|value| *value == 0.0) {
            continue;
        }
        let share = (weight / total).powi(2);
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        bias += share * h.iter().map(|h| (h.iter().sum::<f64>() / 3.0).powi(2)).sum::<f64>() / count;

        let cross = h.iter().map(|h| (2.0 / 3.0 * dot(&e, h)).powi(2)).sum::<f64>() / count;
        let pairs = (0..h.len()).flat_map(|k| (0..k).map(move |l| (k, l)));
        let own = pairs.map(|(k, l)| dot(&h[k], &h[l]).powi(2)).sum::<f64>() / (0.5 * count * (count - 1.0));
        let squares = h.iter().map(|h| dot(h, h) / 3.0);
        mean_square += share * (cross - 4.0 / 9.0 * own + variance(squares) * count / (count - 1.0));

        let absolute = |h: &[f64; 3], sign: f64| (0..3).map(|c| (e[c] + sign * h[c]).abs()).sum::<f64>() / 3.0;
        mae += share * variance(h.iter().flat_map(|h| [absolute(h, 1.0), absolute(h, -1.0)]));
    }
    let [p95, p99, max] = of_largest(errors);
    let root = |variance: f64| variance.max(0.0).sqrt();
    Noise { mean_square: root(mean_square), bias: root(bias), mae: root(mae), p95, p99, max }
}

fn variance(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    values.map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

/// Standard deviations of the 95th and 99th percentiles and of the maximum.
fn of_largest(errors: &Errors<'_>) -> [f64; 3] {
    let draws = &errors.reference.draws;
    let reach = |i: usize, c: usize| draws.iter().map(|draw| f64::from(draw.channels[c][i].abs())).fold(0.0, f64::max);
    // Errors that surely stay above the 94th percentile whatever is drawn.
    let mut least: Vec<(f64, f64)> = errors
        .counted()
        .flat_map(|(i, weight)| (0..3).map(move |c| (i, c, weight)))
        .map(|(i, c, weight)| ((errors.shrunk(i)[c].abs() - reach(i, c)).max(0.0), weight))
        .collect();
    least.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let total = 3.0 * errors.weights.total();
    let floor = tail_percentile(&least, total, 0.94).unwrap_or(0.0);
    drop(least);
    let candidates: Vec<Candidate> = errors
        .counted()
        .flat_map(|(i, weight)| (0..3).map(move |c| (i, c, weight)))
        .filter_map(|(i, c, weight)| {
            let error = errors.shrunk(i)[c];
            (error.abs() + reach(i, c) >= floor).then(|| Candidate {
                receiver: i as u64,
                weight,
                error,
                draws: std::array::from_fn(|k| f64::from(draws[k % draws.len()].channels[c][i])),
            })
        })
        .collect();
    let rounds: Vec<[f64; 3]> = (0..ROUNDS as u64)
        .into_par_iter()
        .map(|round| {
            let mut values: Vec<(f64, f64)> = candidates
                .iter()
                .map(|candidate| {
                    // The same for all channels of a receiver.
                    let random = random(round, candidate.receiver);
                    let draw = candidate.draws[(random >> 8) as usize % DRAWS];
                    let noise = if random & 1 == 0 { draw } else { -draw };
                    ((candidate.error + noise).abs(), candidate.weight)
                })
                .filter(|(value, _)| *value >= floor)
                .collect();
            values.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
            let percentile = |fraction| tail_percentile(&values, total, fraction).unwrap_or(floor);
            [percentile(0.95), percentile(0.99), values.first().map_or(floor, |(value, _)| *value)]
        })
        .collect();
    std::array::from_fn(|figure| variance(rounds.iter().map(|round| round[figure])).sqrt())
}

/// Bits that depend on the round and the receiver alone (the finalizer of splitmix64).
pub(crate) fn random(round: u64, receiver: u64) -> u64 {
    let mut bits = (round << 40 ^ receiver).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

#[cfg(test)]
mod tests {
    use crate::{metrics::compare, traced::Traced};
    use rayon::prelude::*;

    const SEEDS: usize = 60;
    const FIGURES: [&str; 6] = ["rmse", "bias", "mae", "p95", "p99", "max"];

    /// Over seeds of the truth: what figures do, and what their noise claims.
    #[test]
    #[expect(clippy::print_stdout, reason = "shown with --nocapture: the rates themselves")]
    fn what_is_claimed_covers_what_other_seeds_give() {
        for traced in Traced::all() {
            let references: Vec<_> = (0..SEEDS as u64).into_par_iter().map(|seed| traced.reference(seed)).collect();
            for (strategy, radiance) in traced.strategies() {
                let all: Vec<[(f64, f64); 6]> = references
                    .par_iter()
                    .map(|reference| {
                        let m = compare(&radiance, reference).unwrap();
                        let noise =
                            [Some(m.rmse_noise), m.bias_noise, m.mae_noise, m.p95_noise, m.p99_noise, m.max_noise];
                        let values = [m.rmse, m.bias, m.mae, m.p95, m.p99, m.max];
                        std::array::from_fn(|figure| (values[figure], noise[figure].unwrap()))
                    })
                    .collect();
                for (figure, name) in FIGURES.into_iter().enumerate() {
                    let place = format!("{}, {strategy}, {name}", traced.name);
                    let mean = all.iter().map(|it| it[figure].0).sum::<f64>() / SEEDS as f64;
                    let squares = all.iter().map(|it| (it[figure].0 - mean).powi(2)).sum::<f64>();
                    let deviation = (squares / (SEEDS - 1) as f64).sqrt();
                    let claimed = (all.iter().map(|it| it[figure].1.powi(2)).sum::<f64>() / SEEDS as f64).sqrt();
                    let within = |sigmas: f64| {
                        all.iter().filter(|it| (it[figure].0 - mean).abs() <= sigmas * it[figure].1).count() as f64
                            / SEEDS as f64
                    };
                    println!(
                        "{place}: spread {deviation:.2e}, claimed {claimed:.2e}, ratio {:.2}, within 1σ {:.2}, 2σ {:.2}",
                        deviation / claimed,
                        within(1.0),
                        within(2.0)
                    );
                    // A ratio from 60 seeds is uncertain by 9 %; 95 % of 60 are 57 ± 1.7.
                    assert!(deviation <= 1.3 * claimed, "{place}: {deviation:.2e} against {claimed:.2e}");
                    assert!(within(2.0) >= 0.85, "{place}: only {} within two", within(2.0));
                }
            }
        }
    }
}
