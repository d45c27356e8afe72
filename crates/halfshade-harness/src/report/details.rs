//! Figures that only one strategy has.

use super::{
    groups::Group,
    significant::significant,
    table::{Cell, Column, Table},
};
use crate::Results;

/// One row for each list of figures of each strategy; `None` if the experiment didn't ask for any.
pub(super) fn details(results: &Results, group: &Group) -> Option<Table> {
    let mut labels: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for run in group.runs(results) {
        // Whatever the reference, it is the same that was baked.
        if labels.contains(&run.label.as_str()) {
            continue;
        }
        labels.push(&run.label);
        for detail in &run.details {
            let figures: Vec<String> = detail.values.iter().map(|value| figure(*value)).collect();
            rows.push([run.label.as_str(), &detail.name, &figures.join(" ")].map(Cell::text).to_vec());
        }
    }
    let columns = ["strategy", "of what", "figures"].map(Column::plain).to_vec();
    let title = format!("What was baked: {}", group.place());
    (!rows.is_empty()).then_some(Table { title, columns, rows, notes: Vec::new() })
}

/// Counts as they are, all else to two digits.
fn figure(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value}") } else { significant(value, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        report::{Format, groups::tests::only},
        results::tests::example,
    };

    #[test]
    fn every_list_is_a_row() {
        let table = details(&example(), &only()).unwrap().write(Format::Markdown, "");
        assert!(table.contains("| resolution by shell | 8 64 0.016 |"), "{table}");
        let mut results = example();
        results.runs.iter_mut().for_each(|run| run.details.clear());
        assert!(details(&results, &only()).is_none());
    }
}
