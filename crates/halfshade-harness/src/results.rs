//! Results of an experiment: the schema of `results.json`, `halfshade.results/1`.
//!
//! Keys may be added, none is renamed; units stand in names. What was not measured is `null`.

mod file;
mod seal;
mod validity;

use crate::{
    Device, Part, Published, ReceiverKind,
    classes::ClassError,
    image_metrics::Similarity,
    metrics::Metrics,
    stability::{Stability, StabilityFigures},
    statistics::Spread,
    weights::Weighting,
};
use halfshade_scene::InputFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The name and version of the schema.
pub const SCHEMA: &str = "halfshade.results/1";

/// Strategy of rows that compare a reference with the mesh's.
pub const REFERENCE: &str = "reference";

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
    /// The part of the experiment that these are, if they aren't all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<PartFacts>,
    /// Whether it ran with `--quick`: fewer samples, not to be published.
    pub quick: bool,
    /// Version and commit of the program.
    pub revision: String,
    /// The machine that it ran on.
    pub machine: Machine,
    /// Names of all strategies in a fixed order, which gives each its colour.
    pub strategies: Vec<String>,
    /// Label of the strategy that all others are compared with in verdicts, if the experiment names one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub baseline: Option<String>,
    /// Bounds on how strategies behave, if the experiment states any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<StabilityFigures>,
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

/// A part of an experiment, and what is needed to join it with the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartFacts {
    /// Which part.
    pub part: Part,
    /// Devices that it ran on; the order of runs depends on them.
    pub devices: Vec<Device>,
    /// BLAKE3 hashes of the pictures' files.
    pub files: BTreeMap<String, String>,
    /// BLAKE3 hash of the results as JSON, without this one.
    pub blake3: String,
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

/// Outcome of a run.
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
    /// Number of receivers.
    pub receiver_count: usize,
    /// Strategy name, or `reference` for a reference compared with the mesh's.
    pub strategy: String,
    /// The device that it ran on; the processor, where nothing is said.
    #[serde(default, skip_serializing_if = "Device::is_cpu")]
    pub device: Device,
    /// Name and the parameters set by hand.
    pub label: String,
    /// All parameters.
    pub params: BTreeMap<String, serde_json::Value>,
    /// Its outcome.
    pub status: Status,
    /// Reason why it wasn't measured.
    pub reason: Option<String>,
    /// Its error.
    pub error: Option<ErrorFigures>,
    /// The truth that it was compared with.
    pub truth: Option<TruthFigures>,
    /// Its time.
    pub time: Option<TimeFigures>,
    /// Its memory.
    pub memory: Option<Memory>,
    /// How it behaves, if the experiment states bounds on that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// Figures that only this strategy has, if the experiment asks for them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub details: Vec<Detail>,
    /// Its error taken apart by stages, if the experiment asks for it; of the runs against the mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<StageError>,
}

/// The part of an error that a stage makes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageError {
    /// The stage.
    pub stage: String,
    /// Root mean square of what changes when it is made exact, after all stages before it, in radiance.
    pub rms: f64,
    /// Share of the mean squared error: the mean product of that change and the whole error over the mean square of this. Shares sum
    /// to 1; a negative one hides errors of others.
    pub share: f64,
    /// Shares of the mean squared error of each class of receivers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub classes: BTreeMap<String, f64>,
}

/// A list of figures under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detail {
    /// Their meaning.
    pub name: String,
    /// The figures, in an order that the name tells.
    pub values: Vec<f64>,
}

/// Difference between two strategies on one frame of one scene.
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

/// Errors of a run.
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
    /// Errors by class of what hides the light, if the experiment asks for them.
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

/// Time of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TimeFigures {
    /// Once per scene.
    pub bake_secs: f64,
    /// Per frame: poses, lights; absent without `[timing]`.
    pub prepare_secs: Option<Spread>,
    /// Per frame: all receivers; absent without `[timing]`.
    pub shade_secs: Option<Spread>,
    /// Per frame: copying radiance from a device with memory of its own; absent of others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub read_back_secs: Option<Spread>,
    /// Per frame: shading by the device's own clock; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device_secs: Option<Spread>,
    /// Per frame of several in flight: their time over their number; absent where none were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub streamed_secs: Option<Spread>,
    /// Per frame of several in flight: from its preparation to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latency_secs: Option<Spread>,
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
    /// Seconds to copy radiance from a device with memory of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub read_back_secs: Option<f64>,
    /// Seconds to shade by the device's own clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device_secs: Option<f64>,
    /// Seconds of several frames in flight over their number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub streamed_secs: Option<f64>,
    /// Mean seconds from the preparation of one of them to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latency_secs: Option<f64>,
}

/// Memory of a run.
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
    /// The result as a PNG.
    pub png: String,
    /// The signed error in colours; absent for the truth.
    pub error_png: Option<String>,
    /// FLIP's error of each pixel in colours; from builds with the feature `flip`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flip_png: Option<String>,
    /// Factor by which the PNG was multiplied.
    pub exposure: f32,
}

impl PictureFiles {
    /// Its files.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        [&self.exr, &self.png].into_iter().chain(&self.error_png).chain(&self.flip_png).map(String::as_str)
    }
}

impl Run {
    /// Identity of the measured work: everything but the reference.
    pub fn key(&self) -> String {
        let params: Vec<String> = self.params.iter().map(|(key, value)| format!("{key}={value}")).collect();
        let (strategy, device) = (&self.strategy, self.device.key());
        format!("{}/{}/{}/{strategy}{device}:{}", self.scene, self.frame, self.receivers, params.join(","))
    }

    /// Strategy, receivers, scene and frame, for people.
    pub fn place(&self) -> String {
        format!("`{}` on {} of scene `{}`, frame {}", self.label, self.receivers, self.scene, self.frame)
    }

    /// Whether it is a reference that is compared with the mesh's, and no strategy.
    pub fn is_reference(&self) -> bool {
        self.strategy == REFERENCE
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

impl Sample {
    /// A frame on the processor.
    pub fn new(prepare_secs: f64, shade_secs: f64) -> Self {
        Self {
            prepare_secs,
            shade_secs,
            read_back_secs: None,
            device_secs: None,
            streamed_secs: None,
            latency_secs: None,
        }
    }

    /// Sum of all that was measured: finite if all of it is.
    pub fn sum_secs(&self) -> f64 {
        let others = [self.read_back_secs, self.device_secs, self.streamed_secs, self.latency_secs];
        self.prepare_secs + self.shade_secs + others.into_iter().flatten().sum::<f64>()
    }
}

impl TimeFigures {
    /// Figures of `samples`.
    pub fn of(bake_secs: f64, threads: usize, samples: Vec<Sample>) -> Self {
        let spread = |part: &dyn Fn(&Sample) -> f64| Spread::of(&samples.iter().map(part).collect::<Vec<_>>());
        let whole = spread(&|sample| sample.prepare_secs + sample.shade_secs);
        let of_device = |part: &dyn Fn(&Sample) -> Option<f64>| {
            Spread::of(&samples.iter().map(part).collect::<Option<Vec<_>>>().unwrap_or_default())
        };
        Self {
            bake_secs,
            prepare_secs: spread(&|sample| sample.prepare_secs),
            shade_secs: spread(&|sample| sample.shade_secs),
            read_back_secs: of_device(&|sample| sample.read_back_secs),
            device_secs: of_device(&|sample| sample.device_secs),
            streamed_secs: of_device(&|sample| sample.streamed_secs),
            latency_secs: of_device(&|sample| sample.latency_secs),
            frames_per_sec: whole.filter(|whole| whole.median > 0.0).map(|whole| whole.median.recip()),
            threads,
            samples,
        }
    }
}

impl Results {
    /// Weights of vertices, if any were scored.
    pub fn vertex_weights(&self) -> Option<Weighting> {
        let vertices = self.runs.iter().filter(|run| run.receivers == ReceiverKind::Vertices.to_string());
        vertices.filter_map(|run| run.error.as_ref()).map(|error| error.weights).max_by_key(|it| *it == Weighting::Area)
    }
}

#[cfg(test)]
pub(crate) mod tests;
