//! The verdict: who wins at which price, before all evidence.
//!
//! Per frame of a scene the Pareto front, the fastest below 10, 5 and 2 % of error, and how all stand to a baseline; over several
//! frames geometric means of the same. Errors are relative RMSEs against the first reference; times are those of
//! whole frames, preparation included.

mod advice;
mod contender;
mod over_all;
mod scene;

use super::{groups::Group, table::Table};
use crate::Results;
use contender::{Contender, baseline, contenders};

/// Label, relative error, seconds of a frame and bytes of every strategy that was scored and timed, group by group.
pub fn figures_of_all(results: &Results) -> Vec<(String, f64, f64, f64)> {
    let figures = |it: &Contender<'_>| {
        let bytes = it.run.memory.as_ref().map_or(0, |memory| memory.bytes);
        (it.name().to_owned(), it.error, it.frame_secs, bytes as f64)
    };
    Group::all(results)
        .iter()
        .flat_map(|group| contenders(results, group).iter().map(figures).collect::<Vec<_>>())
        .collect()
}

/// One table per frame on which anything was timed, and one over all if they are several.
pub(super) fn verdicts(results: &Results) -> Vec<Table> {
    let groups = Group::all(results);
    let timed: Vec<(&Group, Vec<Contender<'_>>)> = groups
        .iter()
        .map(|group| (group, contenders(results, group)))
        .filter(|(_, contenders)| !contenders.is_empty())
        .collect();
    let baseline = baseline(results, &timed);
    let of_frames = timed.iter().map(|(group, all)| scene::scene(results, group, all, baseline));
    of_frames.chain(over_all::over_all(&timed, baseline)).collect()
}
