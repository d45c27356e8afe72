//! Median, median absolute deviation, percentiles: what survives a noisy machine.

use serde::{Deserialize, Serialize};

/// Standard deviations of a normal distribution on both sides of its middle that hold 95 % of it.
pub(crate) const NORMAL_95: f64 = 1.959_963_985;

/// Middle and spread of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Median absolute deviation from the median, not scaled to a standard deviation.
    pub mad: f64,
}

impl Spread {
    /// The spread of `samples`; `None` without any.
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

/// The interval between two of the samples that holds the median of what they are drawn from with at least the probability
/// `coverage`, whatever the distribution: from the k-th smallest to the k-th largest, with the largest k for which
/// `1 - 2 P(B < k) >= coverage`, B binomial over the samples with probability ½ (the sign test). `None` of too few samples: five or
/// less for 95 %.
pub fn median_interval(samples: &[f64], coverage: f64) -> Option<[f64; 2]> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let mut below = 0;
    // P(B = k), as long as that can be told from 0.
    let (mut probability, mut tail) = (0.5f64.powi(i32::try_from(count).unwrap_or(i32::MAX)), 0.0);
    while below < count / 2 {
        tail += probability;
        if 2.0 * tail > 1.0 - coverage {
            break;
        }
        below += 1;
        probability *= (count + 1 - below) as f64 / below as f64;
    }
    (below > 0).then(|| [sorted[below - 1], sorted[count - below]])
}

/// The n-th root of the product of n positive values; `None` without any.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (sum / values.len() as f64).exp())
}

/// The smallest value such that at least `fraction` of all are not above it (nearest rank); `sorted` rises.
pub fn percentile(sorted: &[f64], fraction: f64) -> Option<f64> {
    let rank = (fraction * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).or(sorted.last()).copied()
}

/// The t that Student's distribution with 15 degrees of freedom exceeds with a `probability` of at most one half.
///
/// `P(|T| < t) = (2/π) (θ + sin θ cos θ Σ_{j<7} c_j cos^{2j} θ)`, θ = atan(t/√15), c_j = c_{j-1} · 2j/(2j + 1), c_0 = 1, by
/// bisection.
pub fn student_quantile(probability: f64) -> f64 {
    const DEGREES: f64 = 15.0;
    let exceeds = |t: f64| {
        let theta = (t / DEGREES.sqrt()).atan();
        let (sin, cos) = theta.sin_cos();
        let (mut term, mut sum) = (1.0, 0.0);
        for j in 0..7 {
            sum += term;
            term *= cos * cos * f64::from(2 * j + 2) / f64::from(2 * j + 3);
        }
        0.5 - (theta + sin * cos * sum) / std::f64::consts::PI
    };
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if exceeds(middle) > probability { low = middle } else { high = middle }
    }
    high
}

/// The t within which Student's distribution with so many `degrees` of freedom, 3 or more, lies with 95 % on both sides of 0: the
/// expansion about the normal distribution's by powers of 1/degrees, right to 1 %, from 7 on to 1e-3 [Abramowitz1964, 26.7.5].
pub(crate) fn student_two_sided(degrees: f64) -> f64 {
    let z = NORMAL_95;
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z + (terms[0] + (terms[1] + terms[2] / degrees) / degrees) / degrees
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

    #[test]
    fn quantiles_of_students_distribution() {
        // From tables: 15 degrees of freedom.
        for (probability, expected) in [(0.25, 0.6912), (0.05, 1.7531), (0.005, 2.9467), (0.0005, 4.0728)] {
            assert!((student_quantile(probability) - expected).abs() < 1e-4, "{probability}");
        }
    }

    #[test]
    fn both_sides_of_students_distribution() {
        for (degrees, expected) in [(7.0, 2.3646), (15.0, 2.1314), (30.0, 2.0423), (1e9, 1.9600)] {
            assert!((student_two_sided(degrees) - expected).abs() < 1e-3, "{degrees}");
        }
        assert!((student_two_sided(15.0) - student_quantile(0.025)).abs() < 1e-4);
    }

    /// By the binomial distribution: of 7 samples the ends (98.4 %), of 11 the second (98.8 %; the third would hold 93.5 %), of 20
    /// the sixth (95.9 %).
    #[test]
    fn the_interval_of_a_median_is_the_sign_tests() {
        let numbers = |count: u32| (1..=count).rev().map(f64::from).collect::<Vec<_>>();
        let interval = |count| median_interval(&numbers(count), 0.95);
        assert_eq!([interval(0), interval(1), interval(5)], [None; 3]);
        assert_eq!([interval(6), interval(7)], [Some([1.0, 6.0]), Some([1.0, 7.0])]);
        assert_eq!([interval(11), interval(20)], [Some([2.0, 10.0]), Some([6.0, 15.0])]);
    }

    /// Over many draws from a skewed distribution, whose median is known.
    #[test]
    fn the_interval_covers_at_its_rate() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
        let rounds = 4000;
        for count in [7, 11, 25] {
            let held = (0..rounds).filter(|_| {
                let samples: Vec<f64> = (0..count).map(|_| -random.random::<f64>().ln()).collect();
                let [low, high] = median_interval(&samples, 0.95).unwrap();
                (low..=high).contains(&std::f64::consts::LN_2)
            });
            let share = held.count() as f64 / f64::from(rounds);
            assert!((0.94..0.995).contains(&share), "{count}: {share}");
        }
    }
}
