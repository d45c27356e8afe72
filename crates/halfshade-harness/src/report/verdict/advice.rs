//! Hints what to try next: what is missing before a result can be quoted, and where the front has a gap.

use super::{
    super::{groups::Group, units::percent},
    contender::Contender,
};
use crate::results::{Results, Run, Status};

/// Median absolute deviation of a time, as a share of it, from which on a machine is called noisy.
const UNSTEADY: f64 = 0.1;

/// Ratio of both times and errors of neighbours on the front from which on there is a gap.
const GAP: f64 = 3.0;

/// Sentences, none where nothing is to be said.
pub(super) fn advice(results: &Results, group: &Group, all: &[Contender<'_>], front: &[usize]) -> Vec<String> {
    let hints = [
        results.quick.then(|| "Run again without --quick before you quote this.".to_owned()),
        unresolved(all),
        unsteady(all),
        gap(all, front),
        unable(group.strategies(results)),
    ];
    hints.into_iter().flatten().collect()
}

fn unresolved(all: &[Contender<'_>]) -> Option<String> {
    let names: Vec<&str> = all.iter().filter(|it| !it.resolved()).map(|it| it.name()).collect();
    let samples = all.iter().find_map(|it| it.run.truth.as_ref()).map_or(0, |truth| truth.samples);
    let text = format!(
        "The truth of {samples} samples can't tell the error of {} from none: four times as many in [truth] halve what it can \
         tell.",
        names.join(", ")
    );
    (!names.is_empty()).then_some(text)
}

fn unsteady(all: &[Contender<'_>]) -> Option<String> {
    let worst = all.iter().max_by(|a, b| a.unsteadiness().total_cmp(&b.unsteadiness()))?;
    let text = format!(
        "Times vary, those of {} by {}: close other programs, or raise `repeats` in [timing].",
        worst.name(),
        percent(worst.unsteadiness())
    );
    (worst.unsteadiness() > UNSTEADY).then_some(text)
}

/// The widest gap between neighbours on the front, and what differs between them.
fn gap(all: &[Contender<'_>], front: &[usize]) -> Option<String> {
    let width = |pair: &[usize]| {
        let [a, b] = [&all[pair[0]], &all[pair[1]]];
        (b.frame_secs / a.frame_secs).min(a.error / b.error)
    };
    let widest = front.windows(2).max_by(|a, b| width(a).total_cmp(&width(b)))?;
    let [a, b] = [&all[widest[0]], &all[widest[1]]];
    let what = numbers_between(a.run, b.run).map_or_else(
        || "`halfshade list strategies` prints what else both can be set to".to_owned(),
        |parameters| format!("try what lies between in {parameters}"),
    );
    (width(widest) >= GAP).then(|| format!("Nothing lies between {} and {}: {what}.", a.name(), b.name()))
}

/// Numbers that differ between two runs of one strategy.
fn numbers_between(a: &Run, b: &Run) -> Option<String> {
    (a.strategy == b.strategy).then_some(())?;
    let differing = a.params.iter().filter(|(key, value)| value.is_number() && b.params.get(*key) != Some(value));
    let names: Vec<String> = differing.map(|(key, _)| format!("`{key}`")).collect();
    (!names.is_empty()).then(|| names.join(" and "))
}

/// Strategies that can't model the scene; the table has the reasons.
fn unable(runs: Vec<&Run>) -> Option<String> {
    let names: Vec<&str> =
        runs.into_iter().filter(|run| run.status != Status::Ok).map(|run| run.label.as_str()).collect();
    (!names.is_empty()).then(|| format!("Not measured, for reasons in the table: {}.", names.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::{super::contender, *};
    use crate::{report::groups::tests::only, results::tests::example};

    fn hints(results: &Results) -> String {
        let group = only();
        let all = contender::contenders(results, &group);
        advice(results, &group, &all, &contender::front(&all)).join("\n")
    }

    #[test]
    fn hints_name_what_is_missing() {
        let mut results = example();
        let text = hints(&results);
        assert!(text.contains("Nothing lies between fast:bands=4 and exact: `halfshade list"), "{text}");
        assert!(text.contains("Not measured, for reasons in the table: blind."), "{text}");
        assert!(!text.contains("--quick") && !text.contains("Times vary") && !text.contains("samples"), "{text}");
        results.quick = true;
        results.runs[1].strategy = "fast".into();
        results.runs[1].params.insert("bands".into(), 8.into());
        results.runs[1].error.as_mut().unwrap().metrics.resolved = false;
        results.runs[0].time.as_mut().unwrap().samples[0].shade_secs *= 2.0;
        results.runs[0].time.as_mut().unwrap().samples[1].shade_secs *= 1.5;
        let text = hints(&results);
        assert!(text.contains("try what lies between in `bands`") && text.contains("--quick"), "{text}");
        assert!(text.contains("256 samples can't tell the error of exact") && text.contains("Times vary"), "{text}");
    }
}
