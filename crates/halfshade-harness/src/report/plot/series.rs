//! Results as series of points, and their Pareto front.

use super::{
    super::{groups::Group, pareto::front},
    style::Look,
};
use crate::results::{Results, Run};

/// One measured run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) frame: usize,
    /// Not a number where it wasn't timed, which only curves over frames show.
    pub(super) frame_secs: f64,
    pub(super) frame_secs_mad: f64,
    pub(super) error: f64,
    /// Ends of the error's interval; where none is known, one standard deviation of the truth's noise away.
    pub(super) error_ends: [f64; 2],
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
    pub(super) look: Look,
    pub(super) points: Vec<Point>,
}

/// Names and looks of all series of some results: the same in every plot.
pub(super) struct Kinds<'a> {
    results: &'a Results,
    runs: Vec<&'a Run>,
    /// Kinds in the order of their first runs.
    kinds: Vec<String>,
}

impl<'a> Kinds<'a> {
    pub(super) fn new(results: &'a Results) -> Self {
        let is_scored = |run: &&Run| run.reference() == "mesh" && !run.is_reference();
        let runs: Vec<&Run> = results.runs.iter().filter(is_scored).collect();
        let mut all = Self { results, runs, kinds: Vec::new() };
        for run in all.runs.clone() {
            let kind = all.kind(run);
            if !all.kinds.contains(&kind) {
                all.kinds.push(kind);
            }
        }
        all
    }

    /// The strategy, its preset and those of its words that most of its runs don't share.
    fn kind(&self, run: &Run) -> String {
        let own = || self.runs.iter().filter(|other| other.strategy == run.strategy);
        // A value that most of a strategy's runs share needs no label.
        let is_usual = |key: &str, value: &serde_json::Value| {
            2 * own().filter(|other| other.params.get(key) == Some(value)).count() > own().count()
        };
        let told = Told::by(&run.label);
        let words = (run.params.iter())
            .filter(|(key, value)| told.tells(key) && !is_usual(key, value))
            .filter_map(|(key, value)| Some(format!("{key}={}", value.as_str()?)));
        let words: Vec<String> = told.preset.map(str::to_owned).into_iter().chain(words).collect();
        if words.is_empty() { run.strategy.clone() } else { format!("{} {}", run.strategy, words.join(" ")) }
    }

    fn look(&self, run: &Run, kind: &str) -> Look {
        let strategy = self.results.strategies.iter().position(|strategy| *strategy == run.strategy).unwrap_or(0);
        let place = self.kinds.iter().position(|known| known == kind).unwrap_or(0);
        let look = Look::new(strategy, place);
        if run.device.is_cpu() { look } else { look.lighter() }
    }

    /// All series of one frame of one scene.
    pub(super) fn series(&self, group: &Group) -> Vec<Series> {
        let mut runs: Vec<(String, Vec<&Run>)> = Vec::new();
        for run in group.runs(self.results).filter(|run| is_shown(run)) {
            let kind = self.kind(run);
            let name = if run.device.is_cpu() { kind } else { format!("{kind} on {}", run.device) };
            match runs.iter_mut().find(|(known, _)| *known == name) {
                Some((_, runs)) => runs.push(run),
                None => runs.push((name, vec![run])),
            }
        }
        runs.into_iter().filter_map(|(name, runs)| self.one(name, &runs)).collect()
    }

    /// Every variant of one scene over its frames, as a series of its own whose points are in the order of frames.
    pub(super) fn curves(&self, frames: &[&Group]) -> Vec<Series> {
        let runs = || frames.iter().flat_map(|group| group.runs(self.results)).filter(|run| run.reference() == "mesh");
        let mut labels: Vec<&str> = Vec::new();
        let mut curves: Vec<Series> = Vec::new();
        for first in runs().filter(|run| !run.is_reference()) {
            if labels.contains(&first.label.as_str()) {
                continue;
            }
            labels.push(&first.label);
            let kind = self.kind(first);
            let alike: Vec<&Run> =
                runs().filter(|run| run.strategy == first.strategy && self.kind(run) == kind).collect();
            let differs = |key: &str| alike.iter().any(|run| run.params.get(key) != first.params.get(key));
            let numbers = first.params.iter().filter(|(key, value)| value.is_number() && differs(key));
            let numbers: Vec<&str> = numbers.map(|(key, _)| key.as_str()).collect();
            let own = alike.iter().filter(|run| run.label == first.label);
            let mut points: Vec<Point> = own.filter_map(|run| point(run, &numbers)).collect();
            points.sort_by_key(|point| point.frame);
            if points.is_empty() {
                continue;
            }
            let name = if first.device.is_cpu() { kind.clone() } else { format!("{kind} on {}", first.device) };
            let look = self.look(first, &kind);
            curves.push(Series { name, kind, numbers: numbers.join(", "), look, points });
        }
        curves
    }

    /// `None` if it has no point with a place on logarithmic axes.
    fn one(&self, name: String, runs: &[&Run]) -> Option<Series> {
        let first = *runs.first()?;
        let kind = self.kind(first);
        let differs = |key: &str| runs.iter().any(|run| run.params.get(key) != first.params.get(key));
        let numbers: Vec<&str> = first
            .params
            .iter()
            .filter(|(key, value)| value.is_number() && differs(key))
            .map(|(key, _)| key.as_str())
            .collect();
        let points = runs.iter().filter_map(|run| point(run, &numbers));
        let mut points: Vec<Point> = points.filter(|point| point.frame_secs > 0.0).collect();
        points.sort_by(|a, b| a.frame_secs.total_cmp(&b.frame_secs));
        let look = self.look(first, &kind);
        (!points.is_empty()).then(|| Series { name, kind, numbers: numbers.join(", "), look, points })
    }
}

/// Whether a run was both scored against the mesh and timed.
fn is_shown(run: &Run) -> bool {
    run.reference() == "mesh" && run.frame_secs().is_some()
}

/// A run as a point; `None` where it has no place on logarithmic axes.
fn point(run: &Run, numbers: &[&str]) -> Option<Point> {
    let (error, truth) = (run.error.as_ref()?, run.truth.as_ref()?);
    let (m, scale) = (&error.metrics, truth.unshadowed_mean);
    (scale > 0.0).then_some(())?;
    let value = if m.resolved { m.rmse } else { m.rmse.max(truth.rms_standard_error) } / scale;
    let noise = m.rmse_noise / scale;
    let interval = m.intervals.and_then(|intervals| intervals.rel_rmse).filter(|_| m.resolved);
    let spreads = run.time.as_ref().map_or([None; 2], |time| [time.prepare_secs, time.shade_secs]);
    let mads = spreads.into_iter().flatten().map(|spread| spread.mad);
    let point = Point {
        frame: run.frame,
        frame_secs: run.frame_secs().unwrap_or(f64::NAN),
        frame_secs_mad: mads.sum(),
        error: value,
        error_ends: interval.unwrap_or([value - noise, value + noise]),
        resolved: m.resolved,
        numbers: numbers.iter().map(|key| run.params[*key].to_string()).collect::<Vec<_>>().join(", "),
    };
    (point.error > 0.0).then_some(point)
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

/// Points that no other beats in both time and error, in the order of time.
pub(super) fn pareto_front(series: &[Series]) -> Vec<(f64, f64)> {
    let points: Vec<&Point> = series.iter().flat_map(|series| &series.points).collect();
    // Nothing is better than what the truth can't tell from none.
    let ranks: Vec<(f64, f64)> =
        points.iter().map(|point| (point.frame_secs, if point.resolved { point.error } else { 0.0 })).collect();
    front(&ranks).into_iter().map(|place| (points[place].frame_secs, points[place].error)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Device, report::groups::tests::only, results::tests::example};

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let point = |frame_secs, error| Point {
            frame: 0,
            frame_secs,
            frame_secs_mad: 0.0,
            error,
            error_ends: [error; 2],
            resolved: true,
            numbers: String::new(),
        };
        let front = |points| {
            pareto_front(&[Series {
                name: String::new(),
                kind: String::new(),
                numbers: String::new(),
                look: Look::new(0, 0),
                points,
            }])
        };
        let points = vec![point(1.0, 0.5), point(2.0, 0.6), point(3.0, 0.1), point(3.0, 0.2), point(4.0, 0.1)];
        assert_eq!(front(points), [(1.0, 0.5), (3.0, 0.1)]);
        let unresolved = Point { resolved: false, ..point(2.0, 0.3) };
        let slower = Point { frame_secs: 5.0, ..unresolved.clone() };
        assert_eq!(front(vec![point(1.0, 0.5), unresolved, point(3.0, 0.2), slower]), [(1.0, 0.5), (2.0, 0.3)]);
    }

    /// Over frames each variant is a curve, in the looks that its series has elsewhere.
    #[test]
    fn variants_are_curves_over_frames() {
        let mut results = example();
        for frame in [5, 3] {
            let later = example().runs.into_iter().map(|run| Run { frame, time: None, ..run });
            results.runs.extend(later);
        }
        let groups = Group::all(&results);
        let kinds = Kinds::new(&results);
        let curves = kinds.curves(&groups.iter().collect::<Vec<_>>());
        let shown: Vec<(&str, Vec<usize>)> = curves
            .iter()
            .map(|curve| (curve.name.as_str(), curve.points.iter().map(|point| point.frame).collect()))
            .collect();
        assert_eq!(shown, [("fast", vec![0, 3, 5]), ("exact", vec![0, 3, 5])]);
        assert!(curves[0].points[0].frame_secs > 0.0 && curves[0].points[1].frame_secs.is_nan());
        assert_eq!(curves[1].look, kinds.series(&groups[0])[1].look);
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
        let series = Kinds::new(&results).series(&only());
        let shown: Vec<(&str, usize)> = series.iter().map(|s| (s.name.as_str(), s.points.len())).collect();
        assert_eq!(shown, [("fast", 2), ("exact", 1), ("fast exp=series", 1), ("fast as-published", 1)]);
        assert_eq!(series[0].points[1].numbers, "6");
        assert_eq!(series[0].look.color, series[2].look.color);
        assert_ne!((series[0].look.mark, series[0].look.color), (series[2].look.mark, series[1].look.color));
    }

    /// The same on a graphics device is another series, with the same mark in a lighter colour.
    #[test]
    fn devices_part_a_series() {
        let mut results = example();
        let on_device = Run { device: Device::Gpu, ..results.runs[0].clone() };
        results.runs.push(on_device);
        let series = Kinds::new(&results).series(&only());
        let shown: Vec<(&str, usize)> = series.iter().map(|s| (s.name.as_str(), s.look.mark)).collect();
        assert_eq!(shown, [("fast", 0), ("exact", 1), ("fast on gpu", 0)]);
        assert_ne!(series[0].look.color, series[2].look.color);
    }
}
