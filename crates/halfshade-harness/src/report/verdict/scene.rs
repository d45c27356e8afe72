//! The verdict on one frame of a scene.

use super::{
    super::{
        error_cell::between,
        groups::Group,
        significant::significant,
        table::{Cell, Column, Table},
        units::{bytes, percent, seconds},
    },
    advice::advice,
    contender::{Contender, front},
};
use crate::results::Results;

/// Errors below which the fastest is named.
const LIMITS: [f64; 3] = [0.1, 0.05, 0.02];

/// The front of `all` of a group beside `baseline`, a label, and sentences that say who wins.
pub(super) fn scene(results: &Results, group: &Group, all: &[Contender<'_>], baseline: Option<&str>) -> Table {
    let front = front(all);
    let base = baseline.and_then(|label| all.iter().find(|it| it.name() == label));
    let is_shown = |place: &usize| front.contains(place) || base.is_some_and(|base| std::ptr::eq(base, &all[*place]));
    let mut columns = vec![
        Column::plain("Pareto front"),
        Column::plain("error"),
        Column::plain("frame"),
        Column::plain("frames/s"),
        Column::plain("memory"),
    ];
    if base.is_some() {
        columns.extend(["times as fast", "times the error"].map(Column::plain));
    }
    let rows = (0..all.len()).filter(is_shown).map(|place| {
        let it = &all[place];
        let memory = it.run.memory.as_ref().map_or(Cell::empty(), |memory| Cell::text(bytes(memory.bytes)));
        let mut row = vec![
            Cell::text(if front.contains(&place) { it.name().to_owned() } else { format!("({})", it.name()) }),
            Cell::number(error_with_interval(it), it.error),
            Cell::number(seconds(it.frame_secs, 3), it.frame_secs),
            Cell::number(significant(it.frame_secs.recip(), 3), it.frame_secs.recip()),
            memory,
        ];
        if let Some(base) = base {
            row.extend(ratios(it, base));
        }
        row
    });
    let rows = rows.collect();
    let mut notes = vec![fastest(all)];
    notes.extend(base.and_then(|base| beside(all, &front, base)));
    notes.extend(advice(results, group, all, &front));
    Table { title: format!("Verdict: {group}"), columns, rows, notes }
}

fn error(it: &Contender<'_>) -> String {
    if it.resolved() { percent(it.error) } else { format!("below {}", percent(it.error)) }
}

/// The same with its interval, if that is known.
fn error_with_interval(it: &Contender<'_>) -> String {
    let interval = it.metrics.intervals.and_then(|intervals| intervals.rel_rmse).filter(|_| it.resolved());
    interval.map_or_else(|| error(it), |ends| format!("{} ({})", error(it), between(ends, percent)))
}

/// Cells of both ratios; empty for the baseline itself.
fn ratios(it: &Contender<'_>, base: &Contender<'_>) -> [Cell; 2] {
    if std::ptr::eq(it, base) {
        return ["1 (baseline)", "1"].map(Cell::text);
    }
    [it.speed_beside(base), it.error_beside(base)].map(|ratio| Cell::number(ratio.to_string(), ratio.value))
}

/// The fastest below each limit, in a sentence.
fn fastest(all: &[Contender<'_>]) -> String {
    let mut parts: Vec<String> = Vec::new();
    for limit in LIMITS {
        // They are in the order of time.
        let Some(first) = all.iter().find(|it| it.error < limit) else { break };
        parts.push(format!(
            "below {} % {} ({}, {})",
            100.0 * limit,
            first.name(),
            error(first),
            seconds(first.frame_secs, 3)
        ));
    }
    let mut text = match parts.is_empty() {
        true => String::new(),
        false => format!("The fastest: {}.", parts.join("; ")),
    };
    if let Some(limit) = LIMITS.get(parts.len())
        && let Some(nearest) = all.iter().min_by(|a, b| a.error.total_cmp(&b.error))
    {
        let space = if text.is_empty() { "" } else { " " };
        text += &format!(
            "{space}Nothing errs less than {} %; {} comes nearest ({}, {}).",
            100.0 * limit,
            nearest.name(),
            error(nearest),
            seconds(nearest.frame_secs, 3)
        );
    }
    text
}

/// How who errs least below the loosest limit in the least time stands to the baseline, in a sentence.
fn beside(all: &[Contender<'_>], front: &[usize], base: &Contender<'_>) -> Option<String> {
    let on_front = front.iter().map(|place| &all[*place]).filter(|it| !std::ptr::eq(*it, base));
    let chosen = LIMITS.iter().rev().find_map(|limit| on_front.clone().find(|it| it.error < *limit))?;
    let (speed, error) = (chosen.speed_beside(base), chosen.error_beside(base));
    let is_paired = [chosen, base].iter().all(|it| it.metrics.rmse_without.is_some());
    Some(format!(
        "{} is {speed} times as fast as {} and errs {error} times as much (± half a 95 % interval: of paired rounds, and of {}).",
        chosen.name(),
        base.name(),
        if is_paired { "paired receivers" } else { "the truth's noise" }
    ))
}

#[cfg(test)]
mod tests {
    use super::{super::contender::contenders, *};
    use crate::{
        report::{Format, groups::tests::only},
        results::{Sample, TimeFigures, tests::example},
    };

    #[test]
    fn a_verdict_names_front_winners_and_ratios() {
        let mut results = example();
        let rounds = |ms: f64| {
            let wobble = [0.0, 0.01, -0.01, 0.02, -0.02, 0.005, -0.005];
            TimeFigures::of(0.0, 2, wobble.map(|w| Sample::new(0.0, 1e-3 * ms * (1.0 + w))).to_vec())
        };
        results.runs[0].error.as_mut().unwrap().metrics.rel_rmse = Some(0.08);
        results.runs[0].time = Some(rounds(2.0));
        let text = scene(&results, &only(), &contenders(&results, &only()), Some("exact")).write(Format::Markdown, "");
        assert!(text.contains("| fast:bands=4 | 8.0 % | 2.00 ms | 500 | 2.00 KiB | 25"), "{text}");
        assert!(text.contains("| exact | 2.0 % | 50.0 ms | 20.0 | 2.00 KiB | 1 (baseline) | 1 |"), "{text}");
        assert!(
            text.contains("The fastest: below 10 % fast:bands=4 (8.0 %, 2.00 ms); below 5 % exact (2.0 %, 50.0 ms).")
        );
        assert!(text.contains("Nothing errs less than 2 %; exact comes nearest"), "{text}");
        assert!(text.contains("fast:bands=4 is 25"), "{text}");
    }
}
