//! The steps of a run, and how many of them are done, for whoever waits for its end.

use super::plan::Plan;
use halfshade_scene::Progress;
use std::sync::atomic::{AtomicU64, Ordering};

/// A count of steps: of each group its references, the score of every variant, and its time.
pub(super) struct Steps<'a> {
    progress: &'a dyn Progress,
    total: u64,
    done: AtomicU64,
}

impl<'a> Steps<'a> {
    /// Those of `plan`, none of them done.
    pub(super) fn of(plan: &Plan, progress: &'a dyn Progress) -> Self {
        let of_a_variant = if plan.timing.is_some() { 2 } else { 1 };
        let total = plan.groups().iter().map(|group| (1 + of_a_variant * group.own.len()) as u64).sum();
        progress.overall(0, total);
        Self { progress, total, done: AtomicU64::new(0) }
    }

    /// Tells that so many more are done.
    pub(super) fn add(&self, count: usize) {
        let before = self.done.fetch_add(count as u64, Ordering::Relaxed);
        self.progress.overall(before + count as u64, self.total);
    }
}
