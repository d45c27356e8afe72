//! The verdict over several frames and scenes.

use super::{
    super::{
        groups::Group,
        pareto,
        ratio::Ratio,
        table::{Cell, Column, Table},
        units::percent,
    },
    contender::{Contender, front},
};

/// Figures of a strategy over all groups.
struct Mean<'a> {
    name: &'a str,
    error: f64,
    speed: Ratio,
    error_ratio: Ratio,
    /// Groups on whose front it is.
    fronts: usize,
}

/// Geometric means over all groups of whoever was measured in each, beside `baseline`; `None` of fewer than two groups, or where the
/// baseline is missing in any.
pub(super) fn over_all(groups: &[(&Group, Vec<Contender<'_>>)], baseline: Option<&str>) -> Option<Table> {
    let bases: Option<Vec<&Contender<'_>>> =
        groups.iter().map(|(_, all)| all.iter().find(|it| Some(it.name()) == baseline)).collect();
    let bases = bases.filter(|bases| bases.len() > 1)?;
    let fronts: Vec<Vec<usize>> = groups.iter().map(|(_, all)| front(all)).collect();
    let means: Vec<Mean<'_>> = groups[0].1.iter().filter_map(|it| mean(it.name(), groups, &bases, &fronts)).collect();
    let points: Vec<(f64, f64)> = means.iter().map(|mean| (mean.speed.value.recip(), mean.error)).collect();
    let order = pareto::front(&points);
    let base = means.iter().position(|mean| mean.name == bases[0].name()).filter(|place| !order.contains(place));
    let rows = order.iter().copied().chain(base).map(|place| {
        let mean = &means[place];
        let name = if order.contains(&place) { mean.name.to_owned() } else { format!("({})", mean.name) };
        let [speed, error_ratio] = match mean.name == bases[0].name() {
            true => ["1 (baseline)", "1"].map(Cell::text),
            false => [mean.speed, mean.error_ratio].map(|ratio| Cell::number(ratio.to_string(), ratio.value)),
        };
        vec![
            Cell::text(name),
            Cell::number(percent(mean.error), mean.error),
            speed,
            error_ratio,
            Cell::text(format!("{} of {}", mean.fronts, groups.len())),
        ]
    });
    let rows = rows.collect();
    let columns = ["Pareto front", "error", "times as fast", "times the error", "on the front of"].map(Column::plain);
    let notes = vec![format!(
        "Geometric means over {} frames of whoever was measured on each; ratios beside {}.",
        groups.len(),
        bases[0].name()
    )];
    Some(Table { title: "Verdict over all".into(), columns: columns.to_vec(), rows, notes })
}

/// `None` if it is missing in any group.
fn mean<'a>(
    name: &'a str,
    groups: &[(&Group, Vec<Contender<'_>>)],
    bases: &[&Contender<'_>],
    fronts: &[Vec<usize>],
) -> Option<Mean<'a>> {
    let (mut log_error, mut speeds, mut errors, mut on_front) = (0.0, Vec::new(), Vec::new(), 0);
    for (((_, all), base), front) in groups.iter().zip(bases).zip(fronts) {
        let place = all.iter().position(|it| it.name() == name)?;
        on_front += usize::from(front.contains(&place));
        let it = &all[place];
        log_error += it.error.ln() / groups.len() as f64;
        speeds.push(it.speed_beside(base));
        errors.push(it.error_beside(base));
    }
    let (speed, error_ratio) = (Ratio::mean(&speeds), Ratio::mean(&errors));
    Some(Mean { name, error: log_error.exp(), speed, error_ratio, fronts: on_front })
}

#[cfg(test)]
mod tests {
    use super::{super::contender::contenders, *};
    use crate::{
        report::Format,
        results::{Sample, TimeFigures, tests::example},
    };

    /// Twice as slow with a quarter of the error in a second scene: means are 2 ms and 8 ms, ratios those of both.
    #[test]
    fn means_are_geometric() {
        let mut results = example();
        let mut second = example().runs;
        for run in &mut second {
            run.scene = "ducks".into();
            if let (Some(time), Some(error)) = (&mut run.time, &mut run.error) {
                *time =
                    TimeFigures::of(0.0, 2, vec![Sample::new(0.0, if run.label == "exact" { 0.05 } else { 0.008 }); 3]);
                error.metrics.rel_rmse = error.metrics.rel_rmse.map(|value| 0.25 * value);
            }
        }
        results.runs.extend(second);
        assert!(over_all(&[], Some("exact")).is_none());
        let groups = Group::all(&results);
        let all: Vec<_> = groups.iter().map(|group| (group, contenders(&results, group))).collect();
        let text = over_all(&all, Some("exact")).unwrap().write(Format::Markdown, "");
        assert!(text.contains("| 10.0 ± 0.1 | 2 of 2 |"), "{text}");
        assert!(text.contains("| exact | 1.0 % | 1 (baseline) | 1 | 2 of 2 |"), "{text}");
        assert!(over_all(&all, Some("nobody")).is_none());
    }
}
