//! Estimates of one quantity by independent scramblings, and what they say of its error.

use crate::options::REPLICATES;
use glam::DVec3;

/// Draws of the noise that come with an estimate.
pub const DRAWS: usize = 8;

/// Independent estimates of one quantity, and what is known of it apart from them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parts {
    pub(crate) replicates: [DVec3; REPLICATES],
    /// Squared error that the spread of the replicates can't show.
    pub(crate) floor_squared: DVec3,
    pub(crate) unshadowed: DVec3,
}

impl Parts {
    pub(crate) const NOTHING: Self =
        Self { replicates: [DVec3::ZERO; REPLICATES], floor_squared: DVec3::ZERO, unshadowed: DVec3::ZERO };

    /// Multiplies all by a factor per channel.
    pub(crate) fn scale(&mut self, factor: DVec3) {
        self.replicates.iter_mut().for_each(|replicate| *replicate *= factor);
        self.floor_squared *= factor * factor;
        self.unshadowed *= factor;
    }

    /// Adds another quantity, known apart from this one.
    pub(crate) fn add(&mut self, other: &Self) {
        self.replicates.iter_mut().zip(&other.replicates).for_each(|(sum, value)| *sum += *value);
        self.floor_squared += other.floor_squared;
        self.unshadowed += other.unshadowed;
    }

    pub(crate) fn mean_and_error(&self) -> (DVec3, DVec3) {
        let mean = self.replicates.iter().sum::<DVec3>() / REPLICATES as f64;
        let squares = self.replicates.iter().map(|r| (*r - mean) * (*r - mean)).sum::<DVec3>();
        let variance = squares / (REPLICATES * (REPLICATES - 1)) as f64 + self.floor_squared;
        (mean, variance.max(DVec3::ZERO).map(f64::sqrt))
    }

    /// Contrasts of the replicates by the rows of a Hadamard matrix. Error that the spread can't show goes up or down in
    /// all channels alike: a sample that is blocked takes all of them.
    pub(crate) fn draws(&self) -> [DVec3; DRAWS] {
        let floor = self.floor_squared.map(f64::sqrt);
        std::array::from_fn(|draw| {
            let row = draw + 1;
            let sign = |replicate: usize| if (row & replicate).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
            let contrast: DVec3 = self.replicates.iter().enumerate().map(|(number, value)| sign(number) * *value).sum();
            contrast / REPLICATES as f64 + if draw % 2 == 0 { floor } else { -floor }
        })
    }
}
