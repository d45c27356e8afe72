//! Candidates that are worth a full run.

use super::{Bounds, trial::Trial};

/// Most candidates that are run in full.
const MOST: usize = 10;

/// Factors by which the error at a sample and the time of a few frames may be off.
const ERROR_SLACK: f64 = 1.1;
const TIME_SLACK: f64 = 1.3;

/// Those that may be the choice, cheapest first, and for the picture those on the front of what was tried.
pub(super) fn shortlist<'a>(trials: &'a [Trial], bounds: &Bounds) -> Vec<&'a Trial> {
    let cost = |trial: &Trial| bounds.cost(&trial.figures);
    let loosened = Bounds {
        error: bounds.error.map(|error| ERROR_SLACK * error),
        frame_secs: bounds.frame_secs.map(|secs| TIME_SLACK * secs),
        ..*bounds
    };
    let slack = if bounds.error.is_some() { TIME_SLACK } else { ERROR_SLACK };
    let met = trials.iter().filter(|trial| bounds.are_met(&trial.figures));
    let best = met.map(cost).fold(f64::INFINITY, f64::min);
    let mut chosen: Vec<&Trial> =
        trials.iter().filter(|trial| loosened.are_met(&trial.figures) && cost(trial) <= slack * best).collect();
    chosen.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    // Of those that only may be within the bounds the cheapest few: one of them mostly is.
    chosen.truncate(MOST - 2);
    let mut rest: Vec<&Trial> = front(trials);
    rest.sort_by(|a, b| bounds.strain(&a.figures).total_cmp(&bounds.strain(&b.figures)));
    for trial in rest {
        let is_there = chosen.iter().any(|other| other.candidate.variant == trial.candidate.variant);
        if !is_there && chosen.len() < MOST {
            chosen.push(trial);
        }
    }
    chosen
}

/// Those that nothing beats in both time and error.
fn front(trials: &[Trial]) -> Vec<&Trial> {
    let points: Vec<(f64, f64)> = trials.iter().map(|trial| (trial.figures.frame_secs, trial.figures.error)).collect();
    crate::report::pareto_front(&points).into_iter().map(|place| &trials[place]).collect()
}
