//! The choice of a strategy and its parameters: the fastest that stays within an error, or the most exact within a frame's time.
//!
//! Parameters tell the levels at which they trade error for time, from the cheapest on; all combinations of a strategy are its
//! candidates. They are tried from the cheapest on, all strategies in turn, on one frame: the truth is traced at a sample of the
//! receivers only, and a frame is timed once or twice. A candidate is left out if a cheaper one of its strategy, no level of
//! which is higher, already errs less than it may (what costs more can only be slower), takes longer than it may, or is larger.
//! Those near the front of what was tried are then run in full, and the choice is made of that.

mod bounds;
mod candidates;
mod outcome;
mod search;
mod shortlist;
mod trial;

pub use bounds::Bounds;
pub use outcome::{Choice, Outcome};

use crate::{
    Experiment, HarnessError, Results,
    experiment::Comparison,
    run::{Plan, RunOptions, Tools, run},
};
use candidates::candidates;
use search::{Search, Tried};
use shortlist::shortlist;

/// Searches the strategies of `comparison` for what meets `bounds` on its scene, runs the best of it with `options`, and chooses.
///
/// # Errors
/// A scene that can't be read; no strategy that models it; whatever stops a run.
pub fn tune(
    comparison: &Comparison,
    bounds: &Bounds,
    tools: &Tools<'_>,
    options: &RunOptions,
) -> Result<Outcome, HarnessError> {
    let experiment: Experiment = comparison.experiment()?;
    let plan = Plan::new(&experiment, tools.strategies, options)?;
    let candidates = candidates(tools, &plan.variants)?;
    let count = candidates.len();
    let Tried { trials, sample, receivers } = Search { tools, plan: &plan, bounds }.run(candidates)?;
    if trials.is_empty() {
        let problem =
            format!("no strategy models scene `{}` on frame {}", plan.scenes[0].scene.name, plan.scenes[0].frames[0]);
        return Err(HarnessError::input(problem));
    }
    let chosen = shortlist(&trials, bounds);
    let strategies = chosen.iter().map(|trial| trial.candidate.spec.clone()).collect();
    let experiment = Comparison { strategies, ..comparison.clone() }.experiment()?;
    let results: Results = run(&experiment, tools, options)?;
    let choice =
        Choice::of(&results, bounds).ok_or_else(|| HarnessError::input("nothing could be measured in full"))?;
    Ok(Outcome { choice, bounds: *bounds, tried: trials.len(), count, sample, receivers, results })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReceiverKind, SystemClock, toy};
    use halfshade_scene::{cache::Cache, progress::Silent};

    fn comparison(strategies: &[&str]) -> Comparison {
        Comparison {
            purpose: "tune",
            scenes: vec!["one-sphere".into()],
            environment: None,
            strategies: strategies.iter().map(|name| (*name).to_owned()).collect(),
            baseline: None,
            frame: 0,
            still: false,
            receivers: ReceiverKind::Vertices,
            samples: 4,
            pictures: false,
        }
    }

    fn tuned(strategies: &[&str], bounds: &Bounds) -> Result<Outcome, String> {
        let (all, clock, cache) = (toy::strategies(), SystemClock::start(), Cache::disabled());
        let tools = Tools {
            strategies: &all,
            graphics: None,
            band_limit: &|environment, _| environment.clone(),
            cache: &cache,
            progress: &Silent,
            clock: &clock,
            revision: "",
        };
        let out = tempfile::tempdir().unwrap();
        let options = RunOptions { out: Some(out.path().join("out")), ..RunOptions::default() };
        tune(&comparison(strategies), bounds, &tools, &options).map_err(|error| error.to_string())
    }

    /// All but a sphere's shadow is white: of the factors 0.25, 0.5 and 1 the last errs least, and that of none is 0.
    #[test]
    fn the_choice_meets_the_bounds_or_says_that_nothing_does() {
        let within =
            |error| tuned(&["dim", "black", "broken"], &Bounds { error: Some(error), ..Bounds::default() }).unwrap();
        let exact = within(0.3);
        assert_eq!((exact.choice.label.as_str(), exact.choice.meets_bounds), ("dim:factor=1", true));
        assert!(exact.to_string().starts_with("dim:factor=1: error "), "{exact}");
        assert!(within(2.0).choice.meets_bounds);
        let none = within(1e-6);
        assert_eq!((none.choice.label.as_str(), none.choice.meets_bounds), ("dim:factor=1", false));
        assert!(none.to_string().starts_with("nothing meets these bounds; dim:factor=1 comes nearest"), "{none}");
        let error = tuned(&["broken"], &Bounds { error: Some(1.0), ..Bounds::default() }).unwrap_err();
        assert!(error.contains("no strategy models scene `one-sphere`"), "{error}");
    }

    #[test]
    fn what_a_cheaper_candidate_settles_is_not_tried() {
        let lenient = tuned(&["dim"], &Bounds { error: Some(100.0), ..Bounds::default() }).unwrap();
        assert_eq!((lenient.tried, lenient.count), (1, 3));
        let strict = tuned(&["dim"], &Bounds { error: Some(1e-9), ..Bounds::default() }).unwrap();
        assert_eq!((strict.tried, strict.count), (3, 3));
        let large = tuned(&["dim"], &Bounds { error: Some(1e-9), bytes: Some(1.0), ..Bounds::default() }).unwrap();
        assert_eq!((large.tried, large.choice.meets_bounds), (1, false));
    }
}
