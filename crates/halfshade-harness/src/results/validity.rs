//! Numbers that no measurement gives: those that are not finite or contradict each other.

use super::{PictureFiles, Results, Run, StageError, Status};
use crate::{image_metrics::Similarity, metrics::Metrics};

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
        let of_stage = |stage: &StageError| {
            let classes = stage.classes.values().copied().collect::<Vec<_>>();
            [stage.rms, stage.share].into_iter().chain(classes).map(|value| ("stages", value)).collect::<Vec<_>>()
        };
        let stages = self.stages.iter().flat_map(of_stage);
        let mut figures = error.chain(truth).chain(time).chain(details).chain(stages);
        figures.find(|(_, value)| !value.is_finite()).map(|(name, _)| name)
    }

    /// The first contradiction in it: errors though it wasn't measured, none though it was, sizes or noise below 0.
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
        let (name, value) = metrics.find(|(name, value)| *name != "bias" && *value < 0.0)?;
        Some(format!("{name} of {} is {value}, below 0", self.place()))
    }
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
        published.chain(runs).chain(differences).chain(pictures).next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{results::tests::example, statistics::Spread};

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
        assert!(refused(&|run| run.error = None).contains("no error is told of `exact`"));
        assert!(refused(&|run| run.status = Status::Failed).contains("which isn't `ok`"));
    }
}
