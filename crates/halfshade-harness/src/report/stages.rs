//! Errors taken apart by the stages of each method.

use super::{
    groups::Group,
    significant::significant,
    table::{Cell, Column, Table},
};
use crate::{Results, metrics::relative, results::Run};

/// Runs of a group whose error was taken apart, without those of which one was written otherwise before.
pub(super) fn taken_apart<'a>(results: &'a Results, group: &'a Group) -> impl Iterator<Item = &'a Run> {
    group.runs(results).filter(|run| !run.stages.is_empty())
}

/// A row for every stage of every strategy; `None` if the experiment doesn't ask for it.
pub(super) fn stages(results: &Results, group: &Group) -> Option<Table> {
    let mut classes: Vec<&str> = Vec::new();
    for class in taken_apart(results, group).flat_map(|run| &run.stages).flat_map(|stage| stage.classes.keys()) {
        if !classes.contains(&class.as_str()) {
            classes.push(class);
        }
    }
    let mut rows = Vec::new();
    for run in taken_apart(results, group) {
        let mean = run.truth.as_ref().map_or(0.0, |truth| truth.unshadowed_mean);
        for (place, stage) in run.stages.iter().enumerate() {
            let share = |share: f64| Cell::text(format!("{:.0} %", 100.0 * share));
            let mut row = vec![
                if place == 0 { Cell::text(run.label.clone()) } else { Cell::empty() },
                Cell::text(stage.stage.clone()),
                Cell::text(relative(stage.rms, mean).map_or("no light".into(), |value| significant(value, 3))),
                share(stage.share),
            ];
            let of_class = |class: &&str| stage.classes.get(*class).map_or(Cell::empty(), |value| share(*value));
            row.extend(classes.iter().map(of_class));
            rows.push(row);
        }
    }
    let heads = ["strategy", "stage", "by itself", "share"].map(str::to_owned);
    let heads = heads.into_iter().chain(classes.iter().map(|class| format!("where {class} hides most")));
    let notes = vec![
        "Each stage is made exact in turn, after those above it; *by itself* is the root mean square of what that changes, as a \
         fraction of the mean unshadowed radiance. Shares are of the mean squared error and sum to 100 %; a negative one hides \
         errors of others. The rest is left when all stages are exact."
            .into(),
    ];
    let title = format!("Where the error comes from, stage by stage: {}", group.place());
    (!rows.is_empty()).then(|| Table { title, columns: heads.map(Column::plain).collect(), rows, notes })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::{
        report::{Format, groups::tests::only},
        results::{StageError, tests::example},
    };

    /// The example, with the error of `fast` taken apart.
    pub(in crate::report) fn example_apart() -> Results {
        let mut results = example();
        let stage = |stage: &str, rms, share| StageError {
            stage: stage.into(),
            rms,
            share,
            classes: [("own".to_owned(), share)].into(),
        };
        results.runs[0].stages = vec![stage("bands", 0.1, 1.25), stage("rest", 0.05, -0.25)];
        results
    }

    #[test]
    fn every_stage_is_a_row() {
        let table = stages(&example_apart(), &only()).unwrap().write(Format::Markdown, "");
        assert!(table.contains("| fast:bands=4 | bands | 0.200 | 125 % | 125 % |"), "{table}");
        assert!(table.contains("|  | rest | 0.100 | -25 % | -25 % |"), "{table}");
        assert!(stages(&example(), &only()).is_none());
    }
}
