//! Regression: has any error grown beyond noise since a baseline?
//!
//! A run has grown worse if its RMSE exceeds the baseline's by more than three standard deviations of their combined
//! noise plus 2 % of the baseline. The 2 % allow for processors that round differently; with the same seeds on the same
//! processor the difference is 0. A run that was measured before and isn't any more fails too.

use crate::{
    HarnessError, Results,
    results::{Run, Status},
    table::{Cell, Column, Table, significant},
};

/// Standard deviations of combined noise that pass.
const SIGMAS: f64 = 3.0;
/// Fraction of the baseline that passes.
const TOLERANCE: f64 = 0.02;

/// What a comparison found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What moved beyond the tolerance, either way, and what is new or gone.
    pub moved: Table,
    /// How many runs were compared.
    pub compared: usize,
    /// How many grew worse or are gone.
    pub failures: usize,
}

/// Compares the errors of `now` with those of `baseline`.
pub fn compare(now: &Results, baseline: &Results) -> Result<Comparison, HarnessError> {
    if now.quick != baseline.quick {
        return Err(HarnessError::input("the baseline was made with another --quick: both must be the same"));
    }
    let same = |a: &Run, b: &Run| a.key() == b.key() && (a.reference() == b.reference() || a.status != b.status);
    let mut rows = Vec::new();
    let (mut compared, mut failures) = (0, 0);
    for old in &baseline.runs {
        let Some(new) = now.runs.iter().find(|new| same(new, old)) else {
            failures += 1;
            rows.push(row(old, old_text(old), "gone".into(), "FAILED: no longer measured"));
            continue;
        };
        let (Some(before), Some(after)) = (&old.error, &new.error) else {
            if old.status != new.status {
                let worse = old.status == Status::Ok;
                failures += usize::from(worse);
                let why = new.reason.clone().unwrap_or_default();
                rows.push(row(
                    new,
                    old_text(old),
                    why,
                    if worse { "FAILED: no longer measured" } else { "measured now" },
                ));
            }
            continue;
        };
        compared += 1;
        let (before, after) = (&before.metrics, &after.metrics);
        let allowed = SIGMAS * before.rmse_noise.hypot(after.rmse_noise) + TOLERANCE * before.rmse;
        let change = after.rmse - before.rmse;
        if change.abs() > allowed || !after.rmse.is_finite() {
            let worse = change > allowed || !after.rmse.is_finite();
            failures += usize::from(worse);
            let verdict = if worse { "FAILED: error grew" } else { "better: renew the baseline" };
            rows.push(row(new, significant(before.rmse, 4), significant(after.rmse, 4), verdict));
        }
    }
    for new in now.runs.iter().filter(|new| baseline.runs.iter().all(|old| !same(new, old))) {
        rows.push(row(new, "none".into(), old_text(new), "new: renew the baseline"));
    }
    let columns =
        ["scene", "frame", "strategy", "reference", "baseline RMSE", "RMSE now", "verdict"].map(Column::plain);
    let moved = Table { title: "What moved".into(), columns: columns.to_vec(), rows, notes: Vec::new() };
    Ok(Comparison { moved, compared, failures })
}

fn old_text(run: &Run) -> String {
    match &run.error {
        Some(error) => significant(error.metrics.rmse, 4),
        None => run.reason.clone().unwrap_or_default(),
    }
}

fn row(run: &Run, before: String, after: String, verdict: &str) -> Vec<Cell> {
    [
        run.scene.clone(),
        run.frame.to_string(),
        run.label.clone(),
        run.reference().to_owned(),
        before,
        after,
        verdict.to_owned(),
    ]
    .map(Cell::text)
    .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::example;

    fn with_rmse(rmse: f64) -> Results {
        let mut results = example();
        results.runs[0].error.as_mut().unwrap().metrics.rmse = rmse;
        results
    }

    #[test]
    fn growth_beyond_noise_fails_and_within_it_passes() {
        // The example's noise is 1e-4 on both sides and its RMSE 0.1: 4.24e-4 + 2e-3 pass.
        let verdict = |rmse| {
            let found = compare(&with_rmse(rmse), &example()).unwrap();
            (found.compared, found.failures, found.moved.rows.len())
        };
        assert_eq!(verdict(0.1), (2, 0, 0));
        assert_eq!(verdict(0.1024), (2, 0, 0));
        assert_eq!(verdict(0.1025), (2, 1, 1));
        assert_eq!(verdict(0.05), (2, 0, 1));
        assert_eq!(verdict(f64::NAN), (2, 1, 1));
    }

    #[test]
    fn what_is_gone_fails_and_what_is_new_is_shown() {
        let mut fewer = example();
        fewer.runs.remove(0);
        let gone = compare(&fewer, &example()).unwrap();
        assert_eq!((gone.failures, gone.moved.rows.len()), (1, 1));
        let new = compare(&example(), &fewer).unwrap();
        assert_eq!((new.failures, new.moved.rows.len()), (0, 1));
        let mut broken = example();
        broken.runs[0].status = Status::Failed;
        broken.runs[0].error = None;
        assert_eq!(compare(&broken, &example()).unwrap().failures, 1);
        let quick = Results { quick: true, ..example() };
        assert!(compare(&quick, &example()).is_err());
    }
}
