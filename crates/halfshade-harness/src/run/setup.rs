//! State that all groups of a run share.

use super::{plan::Plan, record::Record, steps::Steps, tools::Tools};
use halfshade_scene::cache::Cache;

/// The plan, and what it is carried out with.
pub(super) struct Setup<'a> {
    pub(super) tools: &'a Tools<'a>,
    pub(super) plan: &'a Plan,
    pub(super) threads: usize,
    pub(super) steps: Steps<'a>,
    pub(super) truth_cache: Cache,
    /// Whether anything is written; if not, nothing is timed or pictured.
    pub(super) is_kept: bool,
}

impl Setup<'_> {
    /// How many timed frames of a variant are still to come.
    pub(super) fn missing_samples(&self, record: &Record, key: &str) -> usize {
        let wanted = self.plan.timing.map_or(0, |timing| timing.repeats.get() as usize);
        wanted.saturating_sub(record.samples(key).len())
    }
}
