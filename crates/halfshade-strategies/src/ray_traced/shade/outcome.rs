//! Results of the rays of a receiver.

use glam::{DVec3, Vec3};

/// Light that a receiver sends out: `apart + known · share`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    /// All that isn't told by a share.
    pub(super) apart: Vec3,
    /// Light that would be sent out if nothing were hidden.
    pub(super) known: Vec3,
    /// The part of it that is seen.
    pub(super) share: Vec3,
}

impl Outcome {
    pub(super) const BLACK: Self = Self { apart: Vec3::ZERO, known: Vec3::ZERO, share: Vec3::ONE };

    pub(super) fn radiance(&self) -> Vec3 {
        self.apart + self.known * self.share
    }
}

/// Light of the samples of a receiver.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    /// Blocked where it is, and as if nothing were.
    pub(super) seen: DVec3,
    pub(super) open: DVec3,
}

impl Sums {
    pub(super) fn add(&mut self, seen: DVec3, open: DVec3) {
        self.seen += seen;
        self.open += open;
    }

    /// The share that is seen, by channel; all of it where no sample carries light.
    pub(super) fn share(&self) -> DVec3 {
        let share =
            |channel: usize| if self.open[channel] > 0.0 { self.seen[channel] / self.open[channel] } else { 1.0 };
        DVec3::new(share(0), share(1), share(2)).min(DVec3::ONE)
    }
}
