//! Strategies beside each other instead of beside the truth.

use super::{
    groups::Group,
    ratio::Ratio,
    significant::significant,
    table::{Cell, Column, Table},
};
use crate::{Results, metrics::relative, results::TimeFigures};

/// One row for each pair; `None` if the experiment asks for none.
pub(super) fn differences(results: &Results, group: &Group) -> Option<Table> {
    let time_of = |label: &str| {
        let mut runs = group.runs(results).filter(|run| run.label == label);
        runs.find_map(|run| run.time.as_ref())
    };
    let rows: Vec<Vec<Cell>> = results
        .differences
        .iter()
        .filter(|it| group.has(&it.scene, it.frame, &it.receivers))
        .map(|it| {
            let ratio = time_of(&it.first).zip(time_of(&it.second)).and_then(|(first, second)| ratio(first, second));
            let of_mean =
                |value: f64, digits| relative(value, it.mean).map_or("no light".into(), |v| significant(v, digits));
            [
                it.first.clone(),
                it.second.clone(),
                of_mean(it.mae, 3),
                of_mean(it.bias, 2),
                of_mean(it.max, 3),
                ratio.map_or(String::new(), |it| it.to_string()),
            ]
            .map(Cell::text)
            .to_vec()
        })
        .collect();
    let columns = ["strategy", "beside", "mean abs. difference", "bias", "max", "shade time"];
    let notes = vec![
        "Differences are fractions of the second strategy's mean radiance, over all channels. Shade time is a multiple of the \
         second's, the median over rounds in which both ran, ± half its 95 % interval where there are rounds enough."
            .into(),
    ];
    let title = format!("Beside each other: {}", group.place());
    (!rows.is_empty()).then(|| Table { title, columns: columns.map(Column::plain).to_vec(), rows, notes })
}

/// Ratio of shading times.
fn ratio(first: &TimeFigures, second: &TimeFigures) -> Option<Ratio> {
    let shading = |time: &TimeFigures| time.samples.iter().map(|sample| sample.shade_secs).collect::<Vec<_>>();
    Ratio::of_times(&shading(first), &shading(second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        report::{Format, groups::tests::only},
        results::tests::example,
    };

    #[test]
    fn every_pair_is_a_row_with_its_ratio_of_times() {
        let table = differences(&example(), &only()).unwrap().write(Format::Markdown, "");
        let row = "| exact | fast:bands=4 | 0.0800 | -0.040 | 0.500 | 25 |";
        assert!(table.contains(row), "{table}");
        assert!(differences(&example(), &Group { frame: 1, ..only() }).is_none());
        let mut untimed = example();
        untimed.runs.iter_mut().for_each(|run| run.time = None);
        let table = differences(&untimed, &only()).unwrap();
        assert_eq!(table.rows[0][5], Cell::empty());
    }
}
