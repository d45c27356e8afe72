//! Numbers that no measurement gives: those that are not finite or contradict each other.

use super::{ErrorFigures, PictureFiles, Results, Run, StageError, Status};
use crate::{
    image_metrics::Similarity, intervals::Intervals, left_out::LeftOut, metrics::Metrics, stability::StabilityFigures,
};

impl Run {
    /// The first of its figures that is not finite, by name.
    pub fn not_finite(&self) -> Option<&'static str> {
        let error = self.error.iter().flat_map(|error| {
            let Similarity { flip, ssim } = error.similarity;
            let of_classes = error
                .classes
                .iter()
                .flat_map(|class| class.metrics.figures().into_iter().chain([("share", class.share)]));
            error
                .metrics
                .figures()
                .into_iter()
                .chain(of_classes)
                .chain(ends(error))
                .chain([("flip", flip.unwrap_or(0.0)), ("ssim", ssim.unwrap_or(0.0))])
        });
        let truth = self.truth.iter().flat_map(|truth| {
            [("rms_standard_error", truth.rms_standard_error), ("unshadowed_mean", truth.unshadowed_mean)]
        });
        let time = self.time.iter().flat_map(|time| {
            let samples = time.samples.iter().map(|sample| ("time", sample.sum_secs()));
            let spreads = [
                ("prepare_secs", time.prepare_secs),
                ("shade_secs", time.shade_secs),
                ("read_back_secs", time.read_back_secs),
                ("device_secs", time.device_secs),
                ("streamed_secs", time.streamed_secs),
                ("latency_secs", time.latency_secs),
            ];
            let spreads = spreads.map(|(name, spread)| (name, spread.map_or(0.0, |it| it.median + it.mad)));
            let of_frame = [("bake_secs", time.bake_secs), ("frames_per_sec", time.frames_per_sec.unwrap_or(0.0))];
            samples.chain(spreads).chain(of_frame)
        });
        let details = self.details.iter().flat_map(|detail| &detail.values).map(|value| ("details", *value));
        let stability = self.stability.and_then(|stability| stability.figures);
        let stability = stability.into_iter().flat_map(StabilityFigures::all);
        let of_stage = |stage: &StageError| {
            let classes = stage.classes.values().copied().collect::<Vec<_>>();
            [stage.rms, stage.share].into_iter().chain(classes).map(|value| ("stages", value)).collect::<Vec<_>>()
        };
        let stages = self.stages.iter().flat_map(of_stage);
        let mut figures = error.chain(truth).chain(time).chain(details).chain(stability).chain(stages);
        figures.find(|(_, value)| !value.is_finite()).map(|(name, _)| name)
    }

    /// The first contradiction in it: errors though it wasn't measured, none though it was, sizes or noise below 0, intervals from a
    /// larger to a smaller number.
    pub(super) fn contradiction(&self) -> Option<String> {
        let is_measured = self.status == Status::Ok;
        if is_measured != self.error.is_some() {
            let told = if is_measured { "no error is told of" } else { "an error is told of" };
            let status = if is_measured { "which is `ok`" } else { "which isn't `ok`" };
            return Some(format!("{told} {}, {status}", self.place()));
        }
        let error = self.error.as_ref()?;
        let of_classes = error.classes.iter().map(|class| &class.metrics);
        let mut metrics = std::iter::once(&error.metrics).chain(of_classes).flat_map(Metrics::figures);
        if let Some((name, value)) = metrics.find(|(name, value)| *name != "bias" && *value < 0.0) {
            return Some(format!("{name} of {} is {value}, below 0", self.place()));
        }
        let (name, [low, high]) = intervals(error).find(|(_, [low, high])| low > high)?;
        Some(format!("the interval of {name} of {} is from {low} to {high}", self.place()))
    }
}

/// Intervals of all receivers and of classes, by the names of their figures.
fn intervals(error: &ErrorFigures) -> impl Iterator<Item = (&'static str, [f64; 2])> {
    let all = std::iter::once(&error.metrics).chain(error.classes.iter().map(|class| &class.metrics));
    all.filter_map(|metrics| metrics.intervals).flat_map(Intervals::all)
}

/// Ends of intervals, and the RMSEs of parts of the receivers.
fn ends(error: &ErrorFigures) -> impl Iterator<Item = (&'static str, f64)> {
    let ends = intervals(error).flat_map(|(_, ends)| ends.map(|end| ("intervals", end)));
    let without = error.metrics.rmse_without.iter().flat_map(LeftOut::values);
    ends.chain(without.map(|rmse| ("rmse_without", *rmse)))
}

impl PictureFiles {
    /// Its figure that is not finite, by name.
    pub fn not_finite(&self) -> Option<String> {
        (!self.exposure.is_finite()).then(|| format!("exposure of {}", self.png))
    }
}

impl Results {
    /// The first number that is not finite, by its place.
    pub(super) fn not_finite(&self) -> Option<String> {
        let published = self.scenes.iter().flat_map(|scene| &scene.published);
        let published =
            published.filter(|it| !it.frames_per_sec.is_finite()).map(|it| format!("published {}", it.method));
        let runs = self.runs.iter().filter_map(|run| Some(format!("{} of {}", run.not_finite()?, run.key())));
        let differences = self.differences.iter().filter_map(|it| {
            let figures = [it.mean, it.bias, it.mae, it.max];
            (!figures.iter().all(|it| it.is_finite()))
                .then(|| format!("the difference of {} and {}", it.first, it.second))
        });
        let pictures = self.pictures.iter().filter_map(PictureFiles::not_finite);
        let bounds = self.stability.iter().flat_map(|bounds| bounds.all());
        let bounds = bounds.filter(|(_, bound)| !bound.is_finite()).map(|(name, _)| format!("the bound of {name}"));
        published.chain(bounds).chain(runs).chain(differences).chain(pictures).next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{results::tests::example, statistics::Spread};

    const NARROW: Intervals = Intervals {
        rmse: [1.0; 2],
        rel_rmse: None,
        bias: [1.0; 2],
        mae: [1.0; 2],
        p95: None,
        p99: Some([1.0; 2]),
        negative: [0.0; 2],
    };

    #[test]
    fn numbers_that_are_not_finite_are_refused_by_name() {
        let refused = |change: &dyn Fn(&mut Results)| {
            let mut results = example();
            change(&mut results);
            results.to_json().unwrap_err().to_string()
        };
        let metrics = |results: &mut Results, change: fn(&mut Metrics)| {
            change(&mut results.runs[1].error.as_mut().unwrap().metrics);
        };
        let max = refused(&|results| metrics(results, |m| m.max = f64::NAN));
        assert!(max.contains("max of vases/0/vertices/exact"), "{max}");
        assert!(refused(&|results| metrics(results, |m| m.p99_noise = Some(f64::INFINITY))).contains("p99_noise"));
        let interval = |results: &mut Results| {
            metrics(results, |m| m.intervals = Some(Intervals { bias: [f64::NAN, 1.0], ..NARROW }));
        };
        assert!(refused(&interval).contains("intervals"));
        assert!(refused(&|results| results.runs[0].details[0].values.push(f64::NAN)).contains("details"));
        assert!(refused(&|results| results.differences[0].max = f64::INFINITY).contains("difference"));
        assert!(refused(&|results| results.scenes[0].published[0].frames_per_sec = f64::NAN).contains("published"));
        let spread = Some(Spread { median: 1.0, mad: f64::NAN });
        let time = refused(&|results| results.runs[0].time.as_mut().unwrap().shade_secs = spread);
        assert!(time.contains("shade_secs"), "{time}");
    }

    /// Results that are read can be written: the two parts of a time are finite, their sum isn't.
    #[test]
    fn numbers_that_are_read_are_finite() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let text = example().to_json().unwrap();
        let huge = text.replace("\"prepare_secs\": 0.0", "\"prepare_secs\": 1.7e308");
        std::fs::write(&path, huge.replace("\"shade_secs\": 0.002", "\"shade_secs\": 1.7e308")).unwrap();
        let error = Results::load(&path).unwrap_err().to_string();
        assert!(error.contains("results.json") && error.contains("time of vases/0/vertices/fast"), "{error}");
    }

    #[test]
    fn what_contradicts_itself_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let refused = |change: &dyn Fn(&mut Run)| {
            let mut results = example();
            change(&mut results.runs[1]);
            std::fs::write(&path, results.to_json().unwrap()).unwrap();
            Results::load(&path).unwrap_err().to_string()
        };
        let metrics = |change: fn(&mut Metrics)| refused(&|run| change(&mut run.error.as_mut().unwrap().metrics));
        let noise = metrics(|m| m.rmse_noise = -1.0);
        assert!(
            noise.contains("rmse_noise of `exact` on vertices of scene `vases`, frame 0 is -1, below 0"),
            "{noise}"
        );
        assert!(metrics(|m| m.max_noise = Some(-1e-9)).contains("max_noise"));
        assert!(metrics(|m| m.p95 = -1.0).contains("p95 of"));
        let turned = metrics(|m| m.intervals = Some(Intervals { mae: [2.0, 1.0], ..NARROW }));
        assert!(turned.contains("the interval of mae of `exact` on vertices of scene `vases`, frame 0 is from 2 to 1"));
        assert!(refused(&|run| run.error = None).contains("no error is told of `exact`"));
        assert!(refused(&|run| run.status = Status::Failed).contains("which isn't `ok`"));
    }
}
