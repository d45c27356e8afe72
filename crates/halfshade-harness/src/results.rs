//! Results of an experiment: the schema of `results.json`, `halfshade.results/1`.
//!
//! Keys may be added, none is renamed; units stand in names. What was not measured is `null`.

use crate::{
    HarnessError, Published, ReceiverKind, classes::ClassError, image_metrics::Similarity, metrics::Metrics,
    statistics::Spread, weights::Weighting,
};
use halfshade_scene::{InputFile, text};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// The name and version of the schema.
pub const SCHEMA: &str = "halfshade.results/1";

/// A whole `results.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// [`SCHEMA`].
    pub schema: String,
    /// The experiment's name.
    pub experiment: String,
    /// The claim it tests.
    pub claim: String,
    /// BLAKE3 hash of the experiment file: resuming and comparing are between equals.
    pub experiment_hash: String,
    /// The files that its scenes are read from, with paths relative to the experiment; absent from results of earlier
    /// versions, which didn't tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inputs: Option<Vec<InputFile>>,
    /// Whether it ran with `--quick`: fewer samples, not to be published.
    pub quick: bool,
    /// Version and commit of the program.
    pub revision: String,
    /// The machine that it ran on.
    pub machine: Machine,
    /// Names of all strategies in a fixed order, which gives each its colour.
    pub strategies: Vec<String>,
    /// The scenes.
    pub scenes: Vec<SceneFacts>,
    /// One entry per scene, frame, kind of receivers, reference and strategy.
    pub runs: Vec<Run>,
    /// Strategies beside each other, if the experiment asks for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub differences: Vec<Difference>,
    /// The pictures, with paths relative to the results.
    pub pictures: Vec<PictureFiles>,
}

/// The machine that an experiment ran on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Threads used.
    pub threads: usize,
    /// Model of the graphics processor, if one was used.
    pub gpu: Option<String>,
    /// Operating system and architecture.
    pub os: String,
}

/// The size of a scene, and what was published of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// Name.
    pub name: String,
    /// Vertices of all objects.
    pub vertices: usize,
    /// Triangles of all objects.
    pub triangles: usize,
    /// Leaf spheres of all objects.
    pub spheres: usize,
    /// Figures to stand beside ours.
    pub published: Vec<Published>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Measured.
    Ok,
    /// The strategy can't model the scene; the reason is given.
    Unsupported,
    /// Something went wrong; the reason is given.
    Failed,
}

/// One strategy on one frame of one scene against one reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Scene name.
    pub scene: String,
    /// Frame number.
    pub frame: usize,
    /// `vertices` or `pixels`.
    pub receivers: String,
    /// How many receivers.
    pub receiver_count: usize,
    /// Strategy name, or `reference` for a reference compared with the mesh's.
    pub strategy: String,
    /// Name and the parameters set by hand.
    pub label: String,
    /// All parameters.
    pub params: BTreeMap<String, serde_json::Value>,
    /// How it ended.
    pub status: Status,
    /// Why it wasn't measured.
    pub reason: Option<String>,
    /// How far off it is.
    pub error: Option<ErrorFigures>,
    /// The truth that it was compared with.
    pub truth: Option<TruthFigures>,
    /// How long it took.
    pub time: Option<TimeFigures>,
    /// How much it holds.
    pub memory: Option<Memory>,
    /// Figures that only this strategy has, if the experiment asks for them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Detail>,
}

/// A list of figures under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detail {
    /// Their meaning.
    pub name: String,
    /// The figures, in an order that the name tells.
    pub values: Vec<f64>,
}

/// How far one strategy is from another on one frame of one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Scene name.
    pub scene: String,
    /// Frame number.
    pub frame: usize,
    /// `vertices` or `pixels`.
    pub receivers: String,
    /// Label of the one.
    pub first: String,
    /// Label of the other.
    pub second: String,
    /// Mean radiance of the second.
    pub mean: f64,
    /// Mean of the first minus that of the second.
    pub bias: f64,
    /// Mean absolute difference.
    pub mae: f64,
    /// Largest absolute difference.
    pub max: f64,
}

/// How far off a run is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorFigures {
    /// `mesh`, `spheres`, `bands=n`.
    pub reference: String,
    /// `direct`: light that comes straight from a source.
    pub transport: String,
    /// Over receivers.
    #[serde(flatten)]
    pub metrics: Metrics,
    /// Weights of receivers; in results of older versions all count alike.
    #[serde(default = "equal")]
    pub weights: Weighting,
    /// By class of what hides the light, if the experiment asks for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub classes: Vec<ClassError>,
    /// Similarity of the pictures, where they were drawn: `flip` and `ssim`.
    #[serde(flatten)]
    pub similarity: Similarity,
}

fn equal() -> Weighting {
    Weighting::Equal
}

/// The truth that a run was compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthFigures {
    /// Samples per receiver.
    pub samples: u64,
    /// Root mean square of the standard error, in radiance.
    pub rms_standard_error: f64,
    /// Mean radiance with every blocker taken away: what errors are relative to.
    pub unshadowed_mean: f64,
}

/// How long a run took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TimeFigures {
    /// Once per scene.
    pub bake_secs: f64,
    /// Per frame: poses, lights; absent without `[timing]`.
    pub prepare_secs: Option<Spread>,
    /// Per frame: all receivers; absent without `[timing]`.
    pub shade_secs: Option<Spread>,
    /// 1 / median of prepare + shade.
    pub frames_per_sec: Option<f64>,
    /// Threads used.
    pub threads: usize,
    /// Every round that counts, in order.
    pub samples: Vec<Sample>,
}

/// One timed frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Seconds to prepare the frame.
    pub prepare_secs: f64,
    /// Seconds to shade all receivers.
    pub shade_secs: f64,
}

/// How much a run holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Sum.
    pub bytes: usize,
    /// Bytes by part.
    pub parts: BTreeMap<String, usize>,
}

/// The files of one picture, relative to the results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PictureFiles {
    /// Scene name.
    pub scene: String,
    /// Frame number.
    pub frame: usize,
    /// The strategy's label, or `truth`.
    pub label: String,
    /// Layers: result, `truth`, `error`.
    pub exr: String,
    /// To look at.
    pub png: String,
    /// The signed error in colours; absent for the truth.
    pub error_png: Option<String>,
    /// Factor by which the PNG was multiplied.
    pub exposure: f32,
}

impl Run {
    /// Identity of the measured work: everything but the reference.
    pub fn key(&self) -> String {
        let params: Vec<String> = self.params.iter().map(|(key, value)| format!("{key}={value}")).collect();
        format!("{}/{}/{}/{}:{}", self.scene, self.frame, self.receivers, self.strategy, params.join(","))
    }

    /// Strategy, receivers, scene and frame, for people.
    pub fn place(&self) -> String {
        format!("`{}` on {} of scene `{}`, frame {}", self.label, self.receivers, self.scene, self.frame)
    }

    /// The reference, or nothing if it wasn't measured.
    pub fn reference(&self) -> &str {
        self.error.as_ref().map_or("", |error| &error.reference)
    }

    /// Median seconds of a whole frame, where it was timed.
    pub fn frame_secs(&self) -> Option<f64> {
        self.time.as_ref()?.frames_per_sec.map(f64::recip)
    }
}

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
            let samples = time.samples.iter().map(|sample| ("time", sample.prepare_secs + sample.shade_secs));
            let spreads = [("prepare_secs", time.prepare_secs), ("shade_secs", time.shade_secs)];
            let spreads = spreads.map(|(name, spread)| (name, spread.map_or(0.0, |it| it.median + it.mad)));
            let of_frame = [("bake_secs", time.bake_secs), ("frames_per_sec", time.frames_per_sec.unwrap_or(0.0))];
            samples.chain(spreads).chain(of_frame)
        });
        let details = self.details.iter().flat_map(|detail| &detail.values).map(|value| ("details", *value));
        let mut figures = error.chain(truth).chain(time).chain(details);
        figures.find(|(_, value)| !value.is_finite()).map(|(name, _)| name)
    }
}

impl Run {
    /// The first contradiction in it: errors though it wasn't measured, none though it was, sizes or noise below 0.
    fn contradiction(&self) -> Option<String> {
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

impl TimeFigures {
    /// Figures of `samples`.
    pub fn of(bake_secs: f64, threads: usize, samples: Vec<Sample>) -> Self {
        let spread = |part: &dyn Fn(&Sample) -> f64| Spread::of(&samples.iter().map(part).collect::<Vec<_>>());
        let whole = spread(&|sample| sample.prepare_secs + sample.shade_secs);
        Self {
            bake_secs,
            prepare_secs: spread(&|sample| sample.prepare_secs),
            shade_secs: spread(&|sample| sample.shade_secs),
            frames_per_sec: whole.filter(|whole| whole.median > 0.0).map(|whole| whole.median.recip()),
            threads,
            samples,
        }
    }
}

impl PictureFiles {
    /// Its figure that is not finite, by name.
    pub fn not_finite(&self) -> Option<String> {
        (!self.exposure.is_finite()).then(|| format!("exposure of {}", self.png))
    }
}

impl Results {
    /// Reads a `results.json`, or the one in a folder.
    pub fn load(path: &Path) -> Result<Self, HarnessError> {
        let path = if path.is_dir() { path.join("results.json") } else { path.to_owned() };
        let text = text::read(&path)?;
        let results: Self = serde_json::from_str(&text).map_err(|error| {
            let problem = format!("not results of Halfshade, or damaged: {error}; run the experiment again");
            HarnessError::at_line(&path, error.line().max(1), problem)
        })?;
        if results.schema != SCHEMA {
            let problem = format!("schema `{}`; this program reads `{SCHEMA}`", results.schema);
            return Err(HarnessError::in_file(&path, problem));
        }
        // Each number is finite, or JSON would not have it; a sum of two may not be.
        if let Some(place) = results.not_finite() {
            let problem = format!("damaged: {place} is not finite; run the experiment again");
            return Err(HarnessError::in_file(&path, problem));
        }
        if let Some(what) = results.runs.iter().find_map(Run::contradiction) {
            return Err(HarnessError::in_file(&path, format!("damaged: {what}; run the experiment again")));
        }
        Ok(results)
    }

    /// The first number that is not finite, by its place.
    fn not_finite(&self) -> Option<String> {
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

    /// Weights of vertices, if any were scored.
    pub fn vertex_weights(&self) -> Option<Weighting> {
        let vertices = self.runs.iter().filter(|run| run.receivers == ReceiverKind::Vertices.to_string());
        vertices.filter_map(|run| run.error.as_ref()).map(|error| error.weights).max_by_key(|it| *it == Weighting::Area)
    }

    /// As JSON, with a line break at the end. Numbers that are not finite, which JSON would turn into `null`, are refused.
    pub fn to_json(&self) -> Result<String, HarnessError> {
        let fail = |problem: String| HarnessError::input(format!("results cannot be written as JSON: {problem}"));
        if let Some(place) = self.not_finite() {
            return Err(fail(format!("{place} is not finite")));
        }
        let mut text = serde_json::to_string_pretty(self).map_err(|error| fail(error.to_string()))?;
        text.push('\n');
        Ok(text)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Two strategies on one scene, with round numbers.
    pub(crate) fn example() -> Results {
        let run = |strategy: &str, label: &str, rmse: f64, ms: f64| Run {
            scene: "vases".into(),
            frame: 0,
            receivers: "vertices".into(),
            receiver_count: 1000,
            strategy: strategy.into(),
            label: label.into(),
            params: BTreeMap::from([("bands".into(), serde_json::json!(4))]),
            status: Status::Ok,
            reason: None,
            error: Some(ErrorFigures {
                reference: "mesh".into(),
                transport: "direct".into(),
                metrics: Metrics {
                    rmse,
                    rel_rmse: Some(2.0 * rmse),
                    bias: -0.5 * rmse,
                    mae: 0.8 * rmse,
                    p95: 2.0 * rmse,
                    p99: 2.5 * rmse,
                    max: 3.0 * rmse,
                    rmse_noise: 1e-4,
                    bias_noise: Some(2e-5),
                    mae_noise: Some(4e-5),
                    p95_noise: Some(2e-4),
                    p99_noise: Some(4e-4),
                    max_noise: Some(1e-3),
                    resolved: true,
                },
                weights: Weighting::Equal,
                classes: Vec::new(),
                similarity: Similarity::default(),
            }),
            truth: Some(TruthFigures { samples: 256, rms_standard_error: 1e-3, unshadowed_mean: 0.5 }),
            time: Some(TimeFigures::of(0.25, 2, vec![Sample { prepare_secs: 0.0, shade_secs: 1e-3 * ms }; 3])),
            memory: Some(Memory { bytes: 2048, parts: BTreeMap::from([("tables".into(), 2048)]) }),
            details: vec![Detail { name: "resolution by shell".into(), values: vec![8.0, 64.0, 0.015625] }],
        };
        let mut blind = run("blind", "blind", 0.0, 1.0);
        blind.status = Status::Unsupported;
        blind.reason = Some("can't model local lights".into());
        (blind.error, blind.truth, blind.time, blind.memory) = (None, None, None, None);
        Results {
            schema: SCHEMA.into(),
            experiment: "example".into(),
            claim: "fast is not exact".into(),
            experiment_hash: "00".into(),
            inputs: Some(vec![InputFile { path: "../scene.toml".into(), blake3: "01".into() }]),
            quick: false,
            revision: "0.1.0".into(),
            machine: Machine { cpu: "an abacus".into(), threads: 2, gpu: None, os: "none".into() },
            strategies: vec!["fast".into(), "exact".into(), "blind".into()],
            scenes: vec![SceneFacts {
                name: "vases".into(),
                vertices: 1000,
                triangles: 2000,
                spheres: 20,
                published: vec![Published {
                    method: "Ren et al. pixel shader".into(),
                    hardware: "GeForce 8800 GTX".into(),
                    source: "[Guerrero2007, 6]".into(),
                    frames_per_sec: 95.0,
                }],
            }],
            runs: vec![run("fast", "fast:bands=4", 0.1, 2.0), run("exact", "exact", 0.01, 50.0), blind],
            differences: vec![Difference {
                scene: "vases".into(),
                frame: 0,
                receivers: "vertices".into(),
                first: "exact".into(),
                second: "fast:bands=4".into(),
                mean: 0.25,
                bias: -0.01,
                mae: 0.02,
                max: 0.125,
            }],
            pictures: Vec::new(),
        }
    }

    #[test]
    fn json_has_the_keys_of_the_contract_and_reads_back() {
        let results = example();
        let text = results.to_json().unwrap();
        assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), results);
        // Files from before there were differences, and those of experiments without.
        let none = Results { differences: Vec::new(), inputs: None, ..results };
        let text = none.to_json().unwrap();
        assert!(!text.contains("differences") && !text.contains("inputs"));
        assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), none);
        let text = example().to_json().unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let run = &json["runs"][0];
        let has = |value: &serde_json::Value, keys: &[&str]| {
            for key in keys {
                assert!(value.get(key).is_some(), "no key {key} in {value}");
            }
        };
        has(&json, &["schema", "experiment", "revision", "machine", "runs"]);
        has(&json["machine"], &["cpu", "threads", "gpu", "os"]);
        has(run, &["scene", "frame", "receivers", "strategy", "params", "status", "reason", "error", "truth", "time"]);
        has(&run["error"], &["reference", "transport", "rmse", "rel_rmse", "bias", "mae", "p95", "p99", "max"]);
        has(&run["error"], &["flip", "ssim", "resolved"]);
        has(&run["truth"], &["samples", "rms_standard_error"]);
        has(&run["time"], &["bake_secs", "prepare_secs", "shade_secs", "frames_per_sec", "samples"]);
        has(&run["time"]["shade_secs"], &["median", "mad"]);
        has(&run["memory"], &["bytes", "parts"]);
        assert_eq!(run["status"], "ok");
        assert_eq!(json["runs"][2]["status"], "unsupported");
    }

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

    #[test]
    fn a_mark_is_no_text_and_other_encodings_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let text = example().to_json().unwrap();
        std::fs::write(&path, [text::MARK, text.as_bytes()].concat()).unwrap();
        assert_eq!(Results::load(&path).unwrap(), example());
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        std::fs::write(&path, wide).unwrap();
        let error = Results::load(&path).unwrap_err().to_string();
        assert!(error.contains("results.json") && error.contains("UTF-16") && error.contains("save it as UTF-8"));
    }

    #[test]
    fn results_of_older_versions_are_read() {
        let mut json: serde_json::Value = serde_json::from_str(&example().to_json().unwrap()).unwrap();
        for run in json["runs"].as_array_mut().unwrap() {
            if let Some(error) = run["error"].as_object_mut() {
                error.retain(|key, _| {
                    !["weights", "classes"].contains(&key.as_str()) && (key == "rmse_noise" || !key.ends_with("_noise"))
                });
            }
        }
        let old: Results = serde_json::from_str(&json.to_string()).unwrap();
        let error = old.runs[0].error.as_ref().unwrap();
        assert_eq!((error.weights, error.metrics.max_noise, error.metrics.rmse_noise), (Weighting::Equal, None, 1e-4));
        assert_eq!(old.vertex_weights(), Some(Weighting::Equal));
    }

    #[test]
    fn damaged_or_foreign_files_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let whole = example().to_json().unwrap();
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        let error = Results::load(folder.path()).unwrap_err().to_string();
        assert!(error.contains("results.json:") && error.contains("damaged"), "{error}");
        std::fs::write(&path, whole.replace(SCHEMA, "halfshade.results/9")).unwrap();
        let error = Results::load(&path).unwrap_err().to_string();
        assert!(error.contains("halfshade.results/9") && error.contains(SCHEMA), "{error}");
        assert!(Results::load(&folder.path().join("none.json")).unwrap_err().to_string().contains("cannot be read"));
    }
}
