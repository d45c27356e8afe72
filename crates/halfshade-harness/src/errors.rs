//! A reference for strategies, and their errors against it, receiver by receiver.

use crate::weights::ReceiverWeights;
use halfshade_scene::RadianceBuffer;
use halfshade_truth::Hider;
use std::sync::Arc;

/// Radiance that a strategy is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Radiance.
    pub radiance: RadianceBuffer,
    /// Standard error of each value; 0 where exact.
    pub standard_error: RadianceBuffer,
    /// Draws of its noise (see [`halfshade_truth::Estimate::draws`]); none if exact.
    pub draws: Vec<RadianceBuffer>,
    /// Mean over receivers, by weight, and channels of the radiance with every blocker taken away.
    pub unshadowed_mean: f64,
    /// The same of each receiver; empty where it isn't known, so that the mean counts as exact.
    pub unshadowed: Arc<[f32]>,
    /// How much each receiver counts.
    pub weights: Arc<ReceiverWeights>,
    /// The kind of object that hides the light at each receiver; empty unless errors are told by class.
    pub hiders: Arc<[Hider]>,
}

impl Reference {
    /// One without noise whose receivers count by `weights`.
    pub fn exact(radiance: RadianceBuffer, unshadowed_mean: f64, weights: Arc<ReceiverWeights>) -> Self {
        let standard_error = RadianceBuffer::zeros(radiance.len());
        let (draws, unshadowed, hiders) = (Vec::new(), Arc::default(), Arc::default());
        Self { radiance, standard_error, draws, unshadowed_mean, unshadowed, weights, hiders }
    }

    /// Root mean square of the standard error.
    pub fn rms_standard_error(&self) -> f64 {
        self.weights.mean(|i| square(&self.standard_error, i)).sqrt()
    }

    /// This reference with the noise of its difference to `other`: both may have been traced with the same samples, so
    /// that draws are subtracted one by one; what they have in common cancels.
    pub fn with_noise_of_difference(&self, other: &Self) -> Self {
        let mut both = self.clone();
        match (both.draws.is_empty(), other.draws.is_empty()) {
            (_, true) => return both,
            (true, false) => {
                both.draws.clone_from(&other.draws);
                both.standard_error = other.standard_error.clone();
                return both;
            }
            (false, false) => {}
        }
        for (draw, other) in both.draws.iter_mut().zip(&other.draws) {
            let values = draw.channels.iter_mut().flatten().zip(other.channels.iter().flatten());
            values.for_each(|(value, other)| *value -= *other);
        }
        for (channel, errors) in both.standard_error.channels.iter_mut().enumerate() {
            for (i, error) in errors.iter_mut().enumerate() {
                let squares = both.draws.iter().map(|draw| f64::from(draw.channels[channel][i]).powi(2));
                *error = (squares.sum::<f64>() / both.draws.len() as f64).sqrt() as f32;
            }
        }
        both
    }
}

/// Mean over channels of the squares of receiver `i`.
pub(crate) fn square(values: &RadianceBuffer, i: usize) -> f64 {
    values.channels.iter().map(|channel| f64::from(channel[i]).powi(2)).sum::<f64>() / 3.0
}

/// The errors of one comparison, by receiver.
pub(crate) struct Errors<'a> {
    pub(crate) radiance: &'a RadianceBuffer,
    pub(crate) reference: &'a Reference,
    pub(crate) weights: &'a ReceiverWeights,
}

impl Errors<'_> {
    /// Receivers that count, with their weights.
    pub(crate) fn counted(&self) -> impl Iterator<Item = (usize, f64)> {
        self.weights.values().iter().copied().enumerate().filter(|(_, weight)| *weight > 0.0)
    }

    /// Strategy − truth, by channel.
    pub(crate) fn at(&self, i: usize) -> [f64; 3] {
        let of = |values: &RadianceBuffer, c: usize| f64::from(values.channels[c][i]);
        std::array::from_fn(|c| of(self.radiance, c) - of(&self.reference.radiance, c))
    }

    /// Mean over channels of e² − s²: the square of the error without what the truth's noise adds to it on average.
    pub(crate) fn square_at(&self, i: usize) -> f64 {
        self.at(i).iter().map(|e| e * e).sum::<f64>() / 3.0 - square(&self.reference.standard_error, i)
    }

    /// Share of the channels of the strategy's radiance that are below 0.
    pub(crate) fn negative_at(&self, i: usize) -> f64 {
        self.radiance.channels.iter().filter(|channel| channel[i] < 0.0).count() as f64 / 3.0
    }

    /// Errors with what the truth's noise adds to their squares on average taken off, as far as there is any.
    pub(crate) fn shrunk(&self, i: usize) -> [f64; 3] {
        let e = self.at(i);
        std::array::from_fn(|c| {
            let s = f64::from(self.reference.standard_error.channels[c][i]);
            if e[c].abs() > s { e[c] * (1.0 - (s / e[c]).powi(2)).sqrt() } else { 0.0 }
        })
    }
}

/// The smallest value such that at least `fraction` of the weight `total` is not above it. `descending` are values with
/// their weights from the largest on, as far as needed; `None` if they don't reach so far.
pub(crate) fn tail_percentile(descending: &[(f64, f64)], total: f64, fraction: f64) -> Option<f64> {
    let mut above = 0.0;
    descending.iter().find_map(|(value, weight)| {
        above += weight;
        (total - above < fraction * total).then_some(*value)
    })
}
