//! Several results side by side: what moved since the first, and by how much.

use super::{
    contents::provenance,
    error_cell::relative_rmse,
    groups::Group,
    page::{Block, Page},
    significant::significant,
    table::{Better, Cell, Column, Table},
    units::{percent, seconds},
};
use crate::{
    Results,
    check::{moved_beyond_noise, multiple_of_noise},
    results::Run,
    statistics::geometric_mean,
};

/// Results under the name that the page gives them.
pub type Named = (String, Results);

/// The page of several results: how many errors moved beyond noise between the first and each other, then group by group the
/// errors and times of all.
pub fn side_by_side(all: &[Named]) -> Page {
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let mut blocks = vec![Block::Title(names.join(" beside "))];
    blocks.extend(all.iter().map(|(name, results)| Block::Note(format!("{name}: {}.", provenance(results)))));
    let Some(((_, first), others)) = all.split_first() else {
        return Page { provenance: String::new(), blocks };
    };
    blocks.push(Block::Table(changes(first, others)));
    for group in Group::all(first) {
        let rows = Rows::of(first, others, &group);
        if rows.pairs().next().is_some() {
            blocks.push(Block::Table(rows.table(&group, &names)));
        }
    }
    Page { provenance: provenance(first), blocks }
}

/// Strategies of a group: the run of the first results, then that of each other.
struct Rows<'a>(Vec<(&'a Run, Vec<Option<&'a Run>>)>);

/// A measurement that both have, and how it changed.
struct Change {
    error: f64,
    time: Option<f64>,
    /// Whether the error moved beyond the noise of both.
    moved: bool,
}

impl<'a> Rows<'a> {
    fn of(first: &'a Results, others: &'a [Named], group: &'a Group) -> Self {
        let same = |a: &Run, b: &Run| a.label == b.label && a.device == b.device;
        let rows = group.strategies(first).into_iter().map(|run| {
            let of_other = |(_, other): &'a Named| group.strategies(other).into_iter().find(|other| same(run, other));
            (run, others.iter().map(of_other).collect())
        });
        Self(rows.collect())
    }

    /// Runs that are in the first results and in another's, by the place of that.
    fn pairs(&self) -> impl Iterator<Item = (usize, &'a Run, &'a Run)> {
        self.0.iter().flat_map(|(first, others)| {
            others.iter().enumerate().filter_map(|(place, other)| Some((place, *first, (*other)?)))
        })
    }

    fn table(&self, group: &Group, names: &[&str]) -> Table {
        let errors = names.iter().map(|name| Column::ranked(format!("rel. RMSE, {name}"), Better::Lower));
        let times = names.iter().map(|name| Column::ranked(format!("frame, {name}"), Better::Lower));
        let changes = names[1..].iter().map(|name| Column::plain(format!("{name}, beside {}", names[0])));
        let columns = std::iter::once(Column::plain("strategy")).chain(errors).chain(times).chain(changes).collect();
        let rows = self.0.iter().map(|(first, others)| {
            let all = || std::iter::once(Some(*first)).chain(others.iter().copied());
            let error = |run: Option<&Run>| match run {
                Some(Run { error: Some(error), .. }) => relative_rmse(&error.metrics),
                Some(run) => Cell::text(run.reason.clone().unwrap_or_default()),
                None => Cell::text("not there"),
            };
            let time = |run: Option<&Run>| {
                let secs = run.and_then(Run::frame_secs);
                secs.map_or(Cell::empty(), |secs| Cell::number(seconds(secs, 3), secs))
            };
            let told = |other: &Option<&Run>| {
                let change = other.and_then(|other| Change::between(first, other));
                Cell::text(change.map_or(String::new(), |change| change.to_string()))
            };
            let label = Cell::text(first.label.clone());
            std::iter::once(label)
                .chain(all().map(error))
                .chain(all().map(time))
                .chain(others.iter().map(told))
                .collect()
        });
        Table { title: group.to_string(), columns, rows: rows.collect(), notes: Vec::new() }
    }
}

impl Change {
    /// `None` if either wasn't measured, or there is nothing that the change could be a part of.
    fn between(first: &Run, other: &Run) -> Option<Self> {
        let (before, after) = (&first.error.as_ref()?.metrics, &other.error.as_ref()?.metrics);
        let error = after.rmse / before.rmse;
        Some(Self {
            error,
            time: first.frame_secs().zip(other.frame_secs()).map(|(before, after)| after / before),
            moved: moved_beyond_noise(before, after, first.truth.as_ref()?.unshadowed_mean),
        })
    }
}

impl std::fmt::Display for Change {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.moved {
            true if self.error.is_finite() => write!(f, "error × {}", significant(self.error, 3))?,
            true => f.write_str("error where there was none")?,
            false => f.write_str("same error")?,
        }
        self.time.map_or(Ok(()), |time| write!(f, ", time × {}", significant(time, 3)))
    }
}

/// A row for each of the other results.
fn changes(first: &Results, others: &[Named]) -> Table {
    let groups = Group::all(first);
    let pairs: Vec<(usize, Change)> = groups
        .iter()
        .flat_map(|group| Rows::of(first, others, group).pairs().collect::<Vec<_>>())
        .filter_map(|(place, before, after)| Some((place, Change::between(before, after)?)))
        .collect();
    let row = |(place, (name, other)): (usize, &Named)| {
        let own = || pairs.iter().filter(|(of, _)| *of == place).map(|(_, change)| change);
        let moved = |grown: bool| own().filter(|it| it.moved && (it.error > 1.0) == grown).count();
        let largest = own().filter(|it| it.moved).map(|it| (it.error - 1.0).abs()).fold(0.0, f64::max);
        let times: Vec<f64> = own().filter_map(|it| it.time).collect();
        let measured = first.runs.iter().chain(&other.runs).filter(|run| run.error.is_some() && !run.is_reference());
        let alone = measured.count() - 2 * own().count();
        [
            name.clone(),
            own().count().to_string(),
            moved(true).to_string(),
            moved(false).to_string(),
            if largest > 0.0 { percent(largest) } else { String::new() },
            geometric_mean(&times).map_or(String::new(), |mean| significant(mean, 3)),
            alone.to_string(),
        ]
        .map(Cell::text)
        .to_vec()
    };
    let columns = ["results", "errors compared", "grew", "shrank", "most", "time, geometric mean", "on one side only"];
    let note = format!(
        "Errors moved if they differ by more than {:.0} standard deviations of both truths' noise and 2 %; times are those of their machines.",
        multiple_of_noise(1)
    );
    Table {
        title: "What moved since the first".into(),
        columns: columns.map(Column::plain).to_vec(),
        rows: others.iter().enumerate().map(row).collect(),
        notes: vec![note],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::Format, results::tests::example};

    fn page(change: impl Fn(&mut Results)) -> String {
        let mut other = example();
        change(&mut other);
        side_by_side(&[("old".into(), example()), ("new".into(), other)]).write(Format::Markdown, &|_| None)
    }

    fn scaled(factor: f64) -> impl Fn(&mut Results) {
        move |results| {
            let metrics = &mut results.runs[0].error.as_mut().unwrap().metrics;
            (metrics.rmse, metrics.rel_rmse) = (factor * metrics.rmse, metrics.rel_rmse.map(|value| factor * value));
        }
    }

    #[test]
    fn what_moved_beyond_noise_is_counted_and_told() {
        let same = page(|_| {});
        assert!(same.contains("| new | 2 | 0 | 0 |  | 1.00 | 0 |"), "{same}");
        assert!(same.contains("| same error, time × 1.00 |"), "{same}");
        let grown = page(scaled(1.1));
        assert!(grown.contains("| new | 2 | 1 | 0 | 10 % | 1.00 | 0 |"), "{grown}");
        assert!(grown.contains("0.200** | 0.220 |") || grown.contains("| error × 1.10, time × 1.00 |"), "{grown}");
        assert!(page(scaled(0.9)).contains("| new | 2 | 0 | 1 | 10 % | 1.00 | 0 |"));
        // Within 2 % processors may round.
        assert!(page(scaled(1.01)).contains("| new | 2 | 0 | 0 |"));
    }

    #[test]
    fn what_is_on_one_side_only_is_said() {
        let gone = page(|results| drop(results.runs.remove(1)));
        assert!(gone.contains("| new | 1 | 0 | 0 |  | 1.00 | 1 |") && gone.contains("| not there |"), "{gone}");
        let slower = page(|results| {
            let time = results.runs[0].time.as_mut().unwrap();
            time.frames_per_sec = time.frames_per_sec.map(|rate| rate / 4.0);
        });
        assert!(slower.contains("| new | 2 | 0 | 0 |  | 2.00 | 0 |"), "{slower}");
        let elsewhere = page(|results| results.runs.iter_mut().for_each(|run| run.scene = "ducks".into()));
        assert!(elsewhere.contains("| new | 0 | 0 | 0 |  |  | 4 |"), "{elsewhere}");
    }
}
