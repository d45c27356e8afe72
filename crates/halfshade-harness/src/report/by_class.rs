//! Error by class of what hides the light at a receiver.

use super::{
    error_cell::relative_rmse,
    groups::Group,
    significant::significant,
    table::{Better, Cell, Column, Table},
};
use crate::{Results, classes::ClassError, results::Run};
use halfshade_truth::LEAST_SHARE;

/// Classes by their names in results, with heads of columns.
const CLASSES: [(&str, &str); 4] =
    [("own", "own object"), ("other", "another object"), ("ground", "the ground"), ("nothing", "nothing")];

/// Relative RMSE of every strategy against the mesh, class by class; `None` if the experiment doesn't ask for it.
pub(super) fn error_by_class(results: &Results, group: &Group) -> Option<Table> {
    let classes_of = |run: &'_ Run| run.error.as_ref().map_or(Vec::new(), |error| error.classes.clone());
    let runs: Vec<(&Run, Vec<ClassError>)> = group
        .runs(results)
        .filter(|run| run.reference() == "mesh")
        .map(|run| (run, classes_of(run)))
        .filter(|(_, classes)| !classes.is_empty())
        .collect();
    let (_, first) = runs.first()?;
    let shown: Vec<(&str, Column)> = CLASSES
        .into_iter()
        .filter_map(|(class, head)| {
            let share = 100.0 * first.iter().find(|found| found.class == class)?.share;
            Some((class, Column::ranked(format!("{head} ({} %)", significant(share, 2)), Better::Lower)))
        })
        .collect();
    let rows = runs.iter().map(|(run, classes)| {
        let cell = |class: &str| {
            let found = classes.iter().find(|found| found.class == class);
            found.map_or(Cell::empty(), |found| relative_rmse(&found.metrics))
        };
        std::iter::once(Cell::text(run.label.as_str())).chain(shown.iter().map(|(class, _)| cell(class))).collect()
    });
    Some(Table {
        title: format!("Error by what hides the light: {} (rel. RMSE)", group.place()),
        rows: rows.collect(),
        columns: std::iter::once(Column::plain("strategy")).chain(shown.iter().map(|(_, c)| c.clone())).collect(),
        notes: vec![format!(
            "A receiver's class is what hides most of its direct light by the mesh: the object that it lies on, another object \
             that has spheres, one that has none (the ground), or nothing, where less than {} % is hidden. In brackets the \
             share of each class. All errors are fractions of the mean unshadowed radiance over all receivers.",
            100.0 * LEAST_SHARE
        )],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        report::{Format, groups::tests::only},
        results::tests::example,
    };

    #[test]
    fn classes_are_columns_in_a_fixed_order() {
        let mut results = example();
        assert!(error_by_class(&results, &only()).is_none());
        for (run, factor) in results.runs.iter_mut().zip([1.0, 2.0]) {
            let error = run.error.as_mut().unwrap();
            let class = |class: &str, share: f64, rel_rmse: f64, resolved| ClassError {
                class: class.into(),
                receivers: 10,
                share,
                metrics: crate::Metrics { rel_rmse: Some(rel_rmse), resolved, ..error.metrics },
            };
            error.classes = vec![class("ground", 0.25, 0.5 / factor, true), class("nothing", 0.75, 0.01, factor > 1.5)];
        }
        let text = error_by_class(&results, &only()).unwrap().write(Format::Markdown, "");
        assert!(text.contains("| strategy | the ground (25 %) | nothing (75 %) |"), "{text}");
        assert!(text.contains("| fast:bands=4 | <u>0.500</u> | **not resolved (about 0.01)** |"), "{text}");
        assert!(
            text.contains("| exact | **0.250** | <u>0.0100</u> |") && text.contains("less than 2 % is hidden"),
            "{text}"
        );
    }
}
