//! Results as series of points, and their Pareto front.

use super::{
    super::{groups::Group, pareto::front},
    style::PALETTE,
};
use crate::results::{Results, Run};
use plotters::style::RGBColor;
use std::collections::BTreeSet;

/// One measured run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) frame_ms: f64,
    pub(super) frame_ms_mad: f64,
    pub(super) error: f64,
    pub(super) error_noise: f64,
    pub(super) resolved: bool,
    /// The numbers among its parameters that differ within the series.
    pub(super) numbers: String,
}

/// Runs of one strategy on one device that differ in numbers only.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub(super) name: String,
    /// The name without its device.
    pub(super) kind: String,
    /// Meaning of the numbers at its points.
    pub(super) numbers: String,
    pub(super) color: RGBColor,
    pub(super) mark: usize,
    pub(super) points: Vec<Point>,
}

/// All series of one frame of one scene.
pub(super) fn series(results: &Results, group: &Group) -> Vec<Series> {
    let runs: Vec<&Run> =
        group.runs(results).filter(|run| run.reference() == "mesh" && run.frame_secs().is_some()).collect();
    let mut all: Vec<Series> = Vec::new();
    for run in &runs {
        // A value that most of a strategy's runs share needs no label.
        let is_usual = |key: &String, value: &serde_json::Value| {
            let own = || runs.iter().filter(|other| other.strategy == run.strategy);
            2 * own().filter(|other| other.params.get(key) == Some(value)).count() > own().count()
        };
        let told = Told::by(&run.label);
        let is_told_by_any =
            |key: &str| runs.iter().any(|other| other.strategy == run.strategy && Told::by(&other.label).tells(key));
        let words = (run.params.iter())
            .filter(|(key, value)| told.tells(key) && !is_usual(key, value))
            .filter_map(|(key, value)| Some(format!("{key}={}", value.as_str()?)));
        let words: Vec<String> = told.preset.map(str::to_owned).into_iter().chain(words).collect();
        let varying: Vec<&str> = run
            .params
            .iter()
            .filter(|(key, value)| {
                value.is_number()
                    && is_told_by_any(key)
                    && runs.iter().any(|other| other.strategy == run.strategy && other.params.get(*key) != Some(value))
            })
            .map(|(key, _)| key.as_str())
            .collect();
        let kind =
            if words.is_empty() { run.strategy.clone() } else { format!("{} {}", run.strategy, words.join(" ")) };
        let name = if run.device.is_cpu() { kind.clone() } else { format!("{kind} on {}", run.device) };
        let (Some(error), Some(truth), Some(time)) = (&run.error, &run.truth, &run.time) else { continue };
        let (m, scale) = (&error.metrics, truth.unshadowed_mean);
        if scale.is_nan() || scale <= 0.0 {
            continue;
        }
        let value = if m.resolved { m.rmse } else { m.rmse.max(truth.rms_standard_error) } / scale;
        let mads = [time.prepare_secs, time.shade_secs].into_iter().flatten().map(|spread| spread.mad);
        let point = Point {
            frame_ms: 1e3 * run.frame_secs().unwrap_or_default(),
            frame_ms_mad: 1e3 * mads.sum::<f64>(),
            error: value,
            error_noise: m.rmse_noise / scale,
            resolved: m.resolved,
            numbers: varying.iter().map(|key| run.params[*key].to_string()).collect::<Vec<_>>().join(", "),
        };
        if !(point.frame_ms > 0.0 && point.error > 0.0) {
            continue;
        }
        match all.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => {
                let place = results.strategies.iter().position(|strategy| *strategy == run.strategy).unwrap_or(0);
                let kinds: BTreeSet<&str> = (all.iter().map(|series| series.kind.as_str()))
                    .filter(|kind| kind.split(' ').next() == Some(&run.strategy))
                    .collect();
                let known = all.iter().find(|series| series.kind == kind).map(|series| series.mark);
                let mark = known.unwrap_or(kinds.len());
                let color = PALETTE[place % PALETTE.len()];
                let color = if run.device.is_cpu() { color } else { lighter(color) };
                let numbers = varying.join(", ");
                all.push(Series { name, kind, numbers, color, mark, points: vec![point] });
            }
        }
    }
    for series in &mut all {
        series.points.sort_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms));
    }
    all
}

/// Parameters that a label tells; all others are the default's or the preset's.
struct Told<'a> {
    preset: Option<&'a str>,
    keys: Vec<&'a str>,
}

impl<'a> Told<'a> {
    /// `label` is `strategy[:[preset,]key=value,...]`.
    fn by(label: &'a str) -> Self {
        let parts = label.split_once(':').map_or("", |(_, parts)| parts).split(',').filter(|part| !part.is_empty());
        let (keys, alone): (Vec<&str>, Vec<&str>) = parts.partition(|part| part.contains('='));
        let key = |part: &'a str| part.split('=').next().unwrap_or(part);
        Self { preset: alone.first().copied(), keys: keys.into_iter().map(key).collect() }
    }

    fn tells(&self, key: &str) -> bool {
        self.keys.contains(&key)
    }
}

/// The colour of a strategy on a graphics device.
fn lighter(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let [r, g, b] = [r, g, b].map(|value| value + (255 - value) / 2);
    RGBColor(r, g, b)
}

/// Points that no other beats in both time and error, in the order of time.
pub(super) fn pareto_front(series: &[Series]) -> Vec<(f64, f64)> {
    let points: Vec<&Point> = series.iter().flat_map(|series| &series.points).collect();
    // Nothing is better than what the truth can't tell from none.
    let ranks: Vec<(f64, f64)> =
        points.iter().map(|point| (point.frame_ms, if point.resolved { point.error } else { 0.0 })).collect();
    front(&ranks).into_iter().map(|place| (points[place].frame_ms, points[place].error)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Device, report::groups::tests::only, results::tests::example};
    use plotters::style::BLACK;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let point = |frame_ms, error| Point {
            frame_ms,
            frame_ms_mad: 0.0,
            error,
            error_noise: 0.0,
            resolved: true,
            numbers: String::new(),
        };
        let front = |points| {
            pareto_front(&[Series {
                name: String::new(),
                kind: String::new(),
                numbers: String::new(),
                color: BLACK,
                mark: 0,
                points,
            }])
        };
        let points = vec![point(1.0, 0.5), point(2.0, 0.6), point(3.0, 0.1), point(3.0, 0.2), point(4.0, 0.1)];
        assert_eq!(front(points), [(1.0, 0.5), (3.0, 0.1)]);
        let unresolved = Point { resolved: false, ..point(2.0, 0.3) };
        let slower = Point { frame_ms: 5.0, ..unresolved.clone() };
        assert_eq!(front(vec![point(1.0, 0.5), unresolved, point(3.0, 0.2), slower]), [(1.0, 0.5), (2.0, 0.3)]);
    }

    #[test]
    fn numbers_join_a_series_and_words_part_it() {
        let mut results = example();
        let mut more = results.runs[0].clone();
        more.params.insert("bands".into(), serde_json::json!(6));
        more.label = "fast:bands=6".into();
        let mut other = more.clone();
        other.params.insert("exp".into(), serde_json::json!("series"));
        other.label = "fast:exp=series,bands=6".into();
        // A preset is told by its name, whatever it sets.
        let mut published = other.clone();
        published.params.insert("limit".into(), serde_json::json!(4.8));
        published.label = "fast:as-published,bands=6".into();
        results.runs.extend([more, other, published]);
        let series = series(&results, &only());
        let shown: Vec<(&str, usize)> = series.iter().map(|s| (s.name.as_str(), s.points.len())).collect();
        assert_eq!(shown, [("fast", 2), ("exact", 1), ("fast exp=series", 1), ("fast as-published", 1)]);
        assert_eq!(series[0].points[1].numbers, "6");
        assert_eq!(series[0].color, series[2].color);
        assert_ne!((series[0].mark, series[0].color), (series[2].mark, series[1].color));
    }

    /// The same on a graphics device is another series, with the same mark in a lighter colour.
    #[test]
    fn devices_part_a_series() {
        let mut results = example();
        let on_device = Run { device: Device::Gpu, ..results.runs[0].clone() };
        results.runs.push(on_device);
        let series = series(&results, &only());
        let shown: Vec<(&str, usize)> = series.iter().map(|s| (s.name.as_str(), s.mark)).collect();
        assert_eq!(shown, [("fast", 0), ("exact", 0), ("fast on gpu", 0)]);
        assert_ne!(series[0].color, series[2].color);
    }
}
