//! Figures that are to stay within bounds, whatever the scene.

use super::{
    groups::Group,
    significant::significant,
    table::{Cell, Column, Table},
};
use crate::{
    Results,
    results::{Run, Status},
    stability::{Stability, StabilityFigures},
};

/// Heads of the figures' columns, in their order.
const FIGURES: [&str; 4] = ["worst error", "negative share", "energy gained", "largest jump"];

/// Every strategy on every scene, and which bounds don't hold; `None` if the experiment states none.
pub(super) fn overview(results: &Results) -> Option<Table> {
    let bounds = results.stability?;
    let groups = Group::all(results);
    let mut labels: Vec<(&str, String)> = Vec::new();
    for run in groups.iter().flat_map(|group| group.strategies(results)) {
        let known = (run.label.as_str(), run.device.to_string());
        if !labels.contains(&known) {
            labels.push(known);
        }
    }
    let is_alone = |group: &Group| groups.iter().filter(|other| other.scene == group.scene).count() == 1;
    let heads = groups.iter().map(|group| if is_alone(group) { group.scene.clone() } else { group.to_string() });
    let columns = std::iter::once("strategy".to_owned()).chain(heads).map(Column::plain).collect();
    let row = |(label, device): &(&str, String)| {
        let cell = |group: &Group| {
            let own = |run: &&Run| run.label == *label && run.device.to_string() == *device;
            group.strategies(results).into_iter().find(own).map_or(Cell::empty(), |run| verdict(run, &bounds))
        };
        let name = if device == "cpu" { (*label).to_owned() } else { format!("{label} on {device}") };
        std::iter::once(Cell::text(name)).chain(groups.iter().map(cell)).collect()
    };
    let notes = vec![format!(
        "Bounds: {}, and no value that isn't finite. What is named breaks its bound; tables by scene have the figures, and the reasons of \
         refusals.",
        FIGURES
            .iter()
            .zip(bounds.all())
            .map(|(name, (_, bound))| format!("{name} {bound}"))
            .collect::<Vec<_>>()
            .join(", ")
    )];
    Some(Table { title: "Stability at the extremes".into(), columns, rows: labels.iter().map(row).collect(), notes })
}

/// All bounds of a run in a word.
fn verdict(run: &Run, bounds: &StabilityFigures) -> Cell {
    let broken = match &run.stability {
        Some(Stability { not_finite: count @ 1.., .. }) => vec![format!("{count} not finite")],
        Some(Stability { figures: Some(figures), .. }) => {
            let pairs = FIGURES.iter().zip(figures.all()).zip(bounds.all());
            let broken = pairs.filter(|((_, (_, value)), (_, bound))| value > bound);
            broken.map(|((name, (_, value)), _)| format!("{name} {}", significant(value, 2))).collect()
        }
        Some(Stability { figures: None, .. }) => return Cell::text("no light"),
        None if run.status == Status::Unsupported => return Cell::text("refused"),
        None => vec!["failed".to_owned()],
    };
    let holds = broken.is_empty();
    Cell::bounded(if holds { "holds".to_owned() } else { broken.join(", ") }, None, holds)
}

/// Every strategy on one scene with all its figures; `None` if the experiment states no bounds.
pub(super) fn stability(results: &Results, group: &Group) -> Option<Table> {
    let bounds = results.stability?;
    let heads = FIGURES.iter().zip(bounds.all()).map(|(name, (_, bound))| format!("{name} (at most {bound})"));
    let columns: Vec<Column> =
        ["strategy", "not finite (at most 0)"].map(str::to_owned).into_iter().chain(heads).map(Column::plain).collect();
    let rows =
        group.strategies(results).into_iter().map(|run| {
            let mut row = vec![Cell::text(run.label.clone())];
            match &run.stability {
                Some(Stability { not_finite, figures }) => {
                    row.push(Cell::bounded(not_finite.to_string(), Some(*not_finite as f64), *not_finite == 0));
                    let pairs = figures.iter().flat_map(|figures| figures.all()).zip(bounds.all());
                    row.extend(pairs.map(|((_, value), (_, bound))| {
                        Cell::bounded(significant(value, 3), Some(value), value <= bound)
                    }));
                }
                None => row.push(Cell::text(run.reason.as_deref().unwrap_or("no reason given"))),
            }
            row.resize(columns.len(), Cell::empty());
            row
        });
    let rows = rows.collect();
    let notes = vec![
        "Errors, jumps and energy are fractions of the mean unshadowed radiance: the largest error of any value; the largest jump \
         between neighbours beyond the truth's own; radiance above both the truth and what is there without blockers."
            .into(),
    ];
    Some(Table { title: format!("Stability: {}", group.place()), columns, rows, notes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        report::{Format, groups::tests::only},
        results::tests::example,
    };

    fn figures(worst_error: f64, jump: f64) -> Option<StabilityFigures> {
        Some(StabilityFigures { worst_error, negative_share: 0.0, energy_gained: 0.001, jump })
    }

    #[test]
    fn what_breaks_a_bound_is_named_and_refusals_are_rows() {
        let mut results = example();
        assert!(overview(&results).is_none() && stability(&results, &only()).is_none());
        results.stability = figures(0.5, 0.1);
        results.runs[0].stability = Some(Stability { not_finite: 0, figures: figures(0.25, 0.3) });
        results.runs[1].stability = Some(Stability { not_finite: 0, figures: figures(0.5, 0.0) });
        let table = overview(&results).unwrap();
        let text = table.write(Format::Markdown, "");
        assert!(text.contains("| fast:bands=4 | ✗ largest jump 0.30 |"), "{text}");
        assert!(text.contains("| exact | ✓ holds |") && text.contains("| blind | refused |"), "{text}");
        assert!(
            text.contains("worst error 0.5, negative share 0, energy gained 0.001, largest jump 0.1, and no"),
            "{text}"
        );
        let html = table.write(Format::Html, "");
        assert!(html.contains("class=\"holds\">✓ holds<") && html.contains("class=\"breaks\">✗ largest"), "{html}");
        let text = stability(&results, &only()).unwrap().write(Format::Markdown, "");
        assert!(text.contains("| fast:bands=4 | ✓ 0 | ✓ 0.250 | ✓ 0 | ✓ 0.00100 | ✗ 0.300 |"), "{text}");
        assert!(text.contains("| blind | can't model local lights |"), "{text}");
        results.runs[0].stability = Some(Stability { not_finite: 7, figures: None });
        assert!(overview(&results).unwrap().write(Format::Markdown, "").contains("| fast:bands=4 | ✗ 7 not finite |"));
    }
}
