//! Errors that are left when a cause is taken away.

use super::{
    error_cell::relative_rmse,
    groups::Group,
    table::{Better, Cell, Column, Table},
};
use crate::Results;

/// Relative RMSE against every reference, strategy by strategy: what is left when a cause is taken away. `None` if there
/// is only one reference.
pub(super) fn error_split(results: &Results, group: &Group) -> Option<Table> {
    let kind = |reference: &str| reference.split('=').next().unwrap_or("").to_owned();
    let mut kinds: Vec<String> = Vec::new();
    let mut labels: Vec<&str> = Vec::new();
    for run in group.runs(results).filter(|run| run.error.is_some()) {
        if !kinds.contains(&kind(run.reference())) {
            kinds.push(kind(run.reference()));
        }
        if !labels.contains(&run.label.as_str()) {
            labels.push(&run.label);
        }
    }
    (kinds.len() > 1).then_some(())?;
    let head = |kind: &str| match kind {
        "mesh" => "against the mesh".to_owned(),
        "spheres" => "against its spheres".to_owned(),
        "bands" => "against its spheres and bands of light".to_owned(),
        "mesh-bands" => "against the mesh and its bands of light".to_owned(),
        other => format!("against {other}"),
    };
    let columns = std::iter::once(Column::plain("strategy"))
        .chain(kinds.iter().map(|kind| Column::ranked(head(kind), Better::Lower)))
        .collect();
    let rows = labels
        .iter()
        .map(|label| {
            let cell = |wanted: &String| {
                group
                    .runs(results)
                    .filter(|run| run.label == *label && kind(run.reference()) == *wanted)
                    .find_map(|run| run.error.as_ref())
                    .map_or(Cell::empty(), |error| relative_rmse(&error.metrics))
            };
            std::iter::once(Cell::text(*label)).chain(kinds.iter().map(cell)).collect()
        })
        .collect();
    Some(Table {
        title: format!("Where the error comes from: {} (rel. RMSE)", group.place()),
        columns,
        rows,
        notes: vec![
            "Rows named `reference:` compare one reference with the mesh's truth: the error of the geometry alone, and of \
             geometry and band-limited light together. The last column leaves a strategy its products, its exponential \
             and its interpolation."
                .into(),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::groups::tests::only, results::tests::example};

    #[test]
    fn a_second_reference_splits_the_error() {
        let mut results = example();
        assert_eq!(error_split(&results, &only()), None);
        let mut run = results.runs[0].clone();
        run.error.as_mut().unwrap().reference = "spheres".into();
        run.error.as_mut().unwrap().metrics.rel_rmse = Some(0.125);
        results.runs.push(run);
        let table = error_split(&results, &only()).unwrap();
        assert_eq!(
            table.rows[0].iter().map(|cell| cell.text.as_str()).collect::<Vec<_>>(),
            ["fast:bands=4", "0.200", "0.125"]
        );
    }
}
