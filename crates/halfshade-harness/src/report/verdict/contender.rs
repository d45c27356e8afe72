//! Strategies that were both scored and timed.

use super::super::{groups::Group, pareto, ratio::Ratio};
use crate::{
    Metrics,
    results::{Results, Run, Status},
    statistics::Spread,
};

/// One of them, on one frame.
pub(super) struct Contender<'a> {
    pub(super) run: &'a Run,
    pub(super) metrics: &'a Metrics,
    /// Relative RMSE; where the truth can't resolve it, what the truth can just resolve.
    pub(super) error: f64,
    /// Median seconds of a whole frame.
    pub(super) frame_secs: f64,
    /// Seconds of every round that counts.
    pub(super) rounds: Vec<f64>,
}

impl<'a> Contender<'a> {
    fn new(run: &'a Run) -> Option<Self> {
        let (error, truth, time) = (run.error.as_ref()?, run.truth.as_ref()?, run.time.as_ref()?);
        let (m, mean) = (&error.metrics, truth.unshadowed_mean);
        let resolvable = if m.resolved { 0.0 } else { truth.rms_standard_error / mean };
        let contender = Self {
            run,
            metrics: m,
            error: m.rel_rmse?.max(resolvable),
            frame_secs: run.frame_secs()?,
            rounds: time.samples.iter().map(|sample| sample.prepare_secs + sample.shade_secs).collect(),
        };
        (contender.frame_secs > 0.0 && contender.error.is_finite()).then_some(contender)
    }

    pub(super) fn name(&self) -> &'a str {
        &self.run.label
    }

    pub(super) fn resolved(&self) -> bool {
        self.metrics.resolved
    }

    /// How many times as fast as `baseline`.
    pub(super) fn speed_beside(&self, baseline: &Self) -> Ratio {
        let of_medians = || Ratio { value: baseline.frame_secs / self.frame_secs, half_width: None };
        Ratio::of_times(&baseline.rounds, &self.rounds).unwrap_or_else(of_medians)
    }

    /// How many times the error of `baseline`.
    pub(super) fn error_beside(&self, baseline: &Self) -> Ratio {
        Ratio::of_errors(self.error / baseline.error, self.metrics, baseline.metrics)
    }

    /// Median absolute deviation of a frame's time as a share of it.
    pub(super) fn unsteadiness(&self) -> f64 {
        Spread::of(&self.rounds).map_or(0.0, |spread| spread.mad / self.frame_secs)
    }
}

/// All of a group, by time.
pub(super) fn contenders<'a>(results: &'a Results, group: &'a Group) -> Vec<Contender<'a>> {
    let runs = group.strategies(results).into_iter().filter(|run| run.status == Status::Ok);
    let mut contenders: Vec<Contender<'_>> = runs.filter_map(Contender::new).collect();
    contenders.sort_by(|a, b| a.frame_secs.total_cmp(&b.frame_secs).then(a.error.total_cmp(&b.error)));
    contenders
}

/// Places of those on the Pareto front, in the order of time. Nothing is better than what the truth can't tell from none.
pub(super) fn front(contenders: &[Contender<'_>]) -> Vec<usize> {
    let points: Vec<(f64, f64)> =
        contenders.iter().map(|it| (it.frame_secs, if it.resolved() { it.error } else { 0.0 })).collect();
    pareto::front(&points)
}

/// Label of what all others are compared with: what the experiment names, else what errs least over all groups that it is in.
pub(super) fn baseline<'a>(results: &'a Results, groups: &[(&Group, Vec<Contender<'a>>)]) -> Option<&'a str> {
    if let Some(named) = &results.baseline {
        return Some(named);
    }
    let all = || groups.iter().flat_map(|(_, all)| all);
    let mean_log = |label: &str| {
        let logs: Vec<f64> = all().filter(|it| it.name() == label).map(|it| it.error.ln()).collect();
        logs.iter().sum::<f64>() / logs.len() as f64
    };
    let count = |label: &str| groups.iter().filter(|(_, all)| all.iter().any(|it| it.name() == label)).count();
    let most = all().map(|it| count(it.name())).max()?;
    let labels = all().map(Contender::name).filter(|label| count(label) == most);
    labels.min_by(|a, b| mean_log(a).total_cmp(&mean_log(b)))
}
