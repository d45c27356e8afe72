//! Experiment files: which scenes, which strategies, which truth, how timed, what pictured.
//!
//! They are TOML. The keys are the types below with their docs, which the guide prints (GUIDE.md) and [`schema`] gives to editors.
//!
//! ```toml
//! name = "soft-shadows"
//! claim = "what the experiment tests, in a sentence"
//!
//! [truth]
//! samples = 1024
//!
//! [[scene]]
//! name = "vases"
//!
//! [[strategy]]
//! name = "a-strategy"
//! bands = [2, 3, 4]                  # a list sweeps; several lists: every combination
//! ```

mod compose;
mod fields;
mod kinds;
mod only;
mod scene_sweep;

pub use compose::Comparison;
pub use fields::Sweep;
pub use kinds::{ReceiverKind, ReferenceKind};
pub(crate) use only::name_of;

use crate::threads::MAX_THREADS;
use crate::{Device, HarnessError, Weighting, stability::StabilityFigures};
use halfshade_scene::{
    SceneError, SphereFit,
    file::Change,
    keys::{self, Spanned},
    scene::MAX_BOUNCES,
    text,
};
use halfshade_truth::MAX_SAMPLES;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    num::{NonZeroU32, NonZeroUsize},
    ops::Range,
    path::{Path, PathBuf},
};

/// Most rounds that are timed, or thrown away before.
const MAX_ROUNDS: u32 = 10_000;

/// The smallest noise that can be asked for: less is beyond what radiance in 32 bits resolves.
const MIN_NOISE: f64 = 1e-6;

/// Bound for the spheres of all objects together; a single object has its own.
const MAX_SPHERES_IN_ALL: usize = 100_000;

/// A whole experiment, as written.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Short name, of tables and of the folder `out/NAME`.
    #[serde(deserialize_with = "fields::folder_name")]
    pub name: String,
    /// The claim that it tests, in a sentence.
    pub claim: String,
    /// Frames of every scene that doesn't say otherwise.
    #[serde(default = "first_frame", deserialize_with = "fields::distinct")]
    pub frames: Vec<usize>,
    /// Devices that strategies run on.
    #[serde(default = "processor", deserialize_with = "fields::distinct")]
    pub devices: Vec<Device>,
    /// Points that are scored.
    #[serde(default = "vertices", deserialize_with = "fields::distinct")]
    pub receivers: Vec<ReceiverKind>,
    /// References that strategies are compared with: `mesh` is the truth; `spheres` has the sphere sets as blockers; `bands`
    /// has light limited to as many bands as the strategy uses, `bands=4` to four, with spheres only where the strategy
    /// reads them. Differences between them take an error apart.
    #[serde(default = "mesh_only", deserialize_with = "fields::distinct")]
    pub references: Vec<ReferenceKind>,
    /// Weights of vertices in errors.
    #[serde(default = "area")]
    pub weights: Weighting,
    /// Whether errors are told by class of what hides the light at a receiver.
    #[serde(default = "yes")]
    pub classes: bool,
    /// Whether strategies are asked for figures that only they have, such as the resolution that they chose.
    #[serde(default)]
    pub details: bool,
    /// Bounds on how strategies behave at extremes, for a table that says where they hold. Without it, there is none.
    pub stability: Option<Spanned<StabilityFigures>>,
    /// Whether errors are taken apart by the stages of each method: each is made exact in turn.
    #[serde(default)]
    pub stages: bool,
    /// SPEC of the strategy that verdicts compare all others with, such as `ray-traced:samples=16`. Without it, what errs least.
    pub baseline: Option<Spanned<String>>,
    /// Pairs of SPECs that are compared with each other too.
    #[serde(default)]
    pub compare: Vec<[Spanned<String>; 2]>,
    /// Exactness of the truth: give either samples or relative_noise.
    pub truth: TruthSettings,
    /// Measurement of time. Without it, none is measured.
    pub timing: Option<TimingSettings>,
    /// Pictures. Without it, none are drawn.
    pub pictures: Option<PictureSettings>,
    /// The scenes, at least one.
    #[serde(rename = "scene")]
    pub scenes: Vec<SceneEntry>,
    /// The strategies, at least one, with their parameters; `halfshade list strategies` prints all.
    #[serde(rename = "strategy")]
    #[schemars(schema_with = "strategy_tables")]
    pub strategies: Vec<Spanned<BTreeMap<String, Spanned<toml::Value>>>>,
    /// Names of the scenes and strategies that are kept of the file, if not all are.
    #[serde(skip)]
    pub only: Vec<String>,
    /// The file that it was read from; empty if there is none.
    #[serde(skip)]
    pub path: PathBuf,
    /// Its text, for places in it and for the hash that resuming compares.
    #[serde(skip)]
    pub text: String,
}

/// One scene of an experiment.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneEntry {
    /// Built-in name, or a scene or mesh file relative to this file; `halfshade list scenes` prints those built in.
    pub name: Spanned<String>,
    /// Light for a mesh file: `sky`, `constant` or an image. The scene's name then says which.
    pub environment: Option<String>,
    /// The frame at which the scene is held still, for methods that need one that doesn't move.
    pub still: Option<Spanned<usize>>,
    /// Frames, if other than the experiment's.
    #[serde(default, deserialize_with = "fields::some_distinct")]
    pub frames: Option<Vec<usize>>,
    /// Points that are scored, if other than the experiment's.
    #[serde(default, deserialize_with = "fields::some_distinct")]
    pub receivers: Option<Vec<ReceiverKind>>,
    /// Diffuse bounces of light, if other than the scene's.
    #[schemars(range(min = 0, max = MAX_BOUNCES))]
    pub bounces: Option<usize>,
    /// Width and height of the camera's picture, if other than the scene's.
    #[serde(default, deserialize_with = "fields::picture_size")]
    pub resolution: Option<[u32; 2]>,
    /// Another view for pictures, such as a close-up.
    pub camera: Option<Spanned<View>>,
    /// Leaf spheres in all, if other than the scene's, shared out among the objects as the scene's own are.
    #[schemars(range(min = 1, max = MAX_SPHERES_IN_ALL))]
    pub spheres: Option<NonZeroUsize>,
    /// Aim of all sphere sets, if other than the scene's.
    pub fit: Option<SphereFit>,
    /// Lists of values, of which every combination is a scene of its own: `{ spheres = [10, 20], "light.1.radiance" = [[1, 1, 1]] }`.
    /// Keys are environment, still, bounces, resolution, spheres, fit, or paths into a scene file.
    #[serde(default, deserialize_with = "fields::lists")]
    #[schemars(schema_with = "fields::schema_of_lists")]
    pub sweep: Sweep,
    /// Published figures to stand beside ours.
    #[serde(default)]
    pub published: Vec<Published>,
    /// Values of the scene file that are others.
    #[serde(skip)]
    pub changes: Vec<Change>,
    /// Words by which the scene's name tells what else was swept.
    #[serde(skip)]
    pub told: Vec<String>,
}

/// Camera of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Eye in world space.
    pub eye: [f32; 3],
    /// The point looked at.
    pub target: [f32; 3],
    /// Angle spanned by the picture's height, between 0 and 180 degrees.
    pub vertical_fov_degrees: f32,
}

/// A frame rate from the literature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// The method, with its authors.
    pub method: String,
    /// Hardware that it ran on.
    pub hardware: String,
    /// Publication that prints it.
    pub source: String,
    /// Frames per second, positive.
    pub frames_per_sec: f64,
}

/// Exactness of the truth: give either `samples` or `relative_noise`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TruthSettings {
    /// Samples per receiver.
    #[schemars(range(min = 1, max = MAX_SAMPLES))]
    pub samples: Option<NonZeroU32>,
    /// Sample until the root mean square of the standard error is below this fraction of the unshadowed mean.
    #[schemars(range(min = MIN_NOISE, max = 1.0))]
    pub relative_noise: Option<f64>,
    /// Seed of the samples.
    #[serde(default = "one")]
    pub seed: u32,
}

/// Measurement of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimingSettings {
    /// Rounds that are thrown away.
    #[schemars(range(min = 0, max = MAX_ROUNDS))]
    pub warm_up: u32,
    /// Rounds that count.
    #[schemars(range(min = 1, max = MAX_ROUNDS))]
    pub repeats: NonZeroU32,
    /// Frames that a graphics device works on at once in a measurement of their own: how many a second, and how long each takes
    /// from its preparation to its end. Without it, there is no such measurement.
    #[serde(default)]
    pub frames_in_flight: Option<NonZeroU32>,
    /// Threads. Without it, all; `--threads` wins.
    #[schemars(range(min = 1, max = MAX_THREADS))]
    pub threads: Option<NonZeroUsize>,
}

/// Settings of pictures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PictureSettings {
    /// Width and height, if other than the camera's.
    #[serde(default, deserialize_with = "fields::picture_size")]
    pub resolution: Option<[u32; 2]>,
    /// SPECs of those that are drawn. Without it, all.
    pub strategies: Option<Vec<Spanned<String>>>,
    /// Two SPECs whose difference, times ten, is a picture too.
    pub difference: Option<[Spanned<String>; 2]>,
}

/// Schema of tables that name a strategy and its parameters, which only the strategy knows.
fn strategy_tables(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array",
        "items": {
            "type": "object",
            "properties": {
                "name": { "type": "string", "description": "Name of the strategy." },
            },
            "required": ["name"],
            "additionalProperties": {
                "anyOf": [{ "type": "string" }, { "type": "number" }, { "type": "array" }],
                "description": "`preset`, or any of its parameters. A list sweeps: each of its values runs, and of several lists \
                                every combination.",
            },
        },
    })
}

/// The JSON Schema of experiment files.
pub fn schema() -> serde_json::Value {
    keys::schema::<Experiment>()
}

fn first_frame() -> Vec<usize> {
    vec![0]
}

fn vertices() -> Vec<ReceiverKind> {
    vec![ReceiverKind::Vertices]
}

fn processor() -> Vec<Device> {
    vec![Device::Cpu]
}

fn mesh_only() -> Vec<ReferenceKind> {
    vec![ReferenceKind::Mesh]
}

fn area() -> Weighting {
    Weighting::Area
}

fn yes() -> bool {
    true
}

fn one() -> u32 {
    1
}

impl Experiment {
    /// Reads the file at `path`.
    pub fn load(path: &Path) -> Result<Self, HarnessError> {
        Self::parse(&text::read(path)?, path)
    }

    /// Reads `text`; `path` is named in errors, and files are relative to it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let mut experiment: Self = keys::parse(text).map_err(|error| match path.as_os_str().is_empty() {
            true => SceneError::new(error.problem),
            false => error.in_file(path),
        })?;
        experiment.path = path.to_owned();
        experiment.text = text.to_owned();
        experiment.validate()?;
        Ok(experiment)
    }

    /// An error about a piece of the file.
    pub fn error_at(&self, span: Range<usize>, problem: impl Into<String>) -> HarnessError {
        if self.path.as_os_str().is_empty() {
            return HarnessError::input(problem);
        }
        HarnessError::at(&self.path, &self.text, span, problem)
    }

    /// The piece of the file from the beginning of a line to the end of what stands at `span`: a key with its value.
    pub(crate) fn statement(&self, span: Range<usize>) -> Range<usize> {
        let before = &self.text[..span.start];
        let line = before.rfind('\n').map_or(before, |end| &before[end + 1..]);
        span.start - line.trim_start().len()..span.end
    }

    /// BLAKE3 hash of the text and of what is kept of it: resuming and comparing are between equals.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.text.as_bytes());
        for name in &self.only {
            hasher.update(b"\0").update(name.as_bytes());
        }
        hasher.finalize().to_hex().to_string()
    }

    fn validate(&self) -> Result<(), HarnessError> {
        let error = |problem: &str| Err(HarnessError::in_file(&self.path, problem));
        if self.scenes.is_empty() || self.strategies.is_empty() {
            return error("needs at least one [[scene]] and one [[strategy]]");
        }
        match (self.truth.samples, self.truth.relative_noise) {
            (Some(_), None) | (None, Some(_)) => {}
            _ => return error("[truth] needs either `samples` or `relative_noise`"),
        }
        if let Some(bounds) = &self.stability
            && let Some((name, _)) =
                bounds.get_ref().all().into_iter().find(|(_, bound)| !(0.0..=f64::MAX).contains(bound))
        {
            let problem = format!("stability: {name} must be finite and not negative");
            return Err(self.error_at(bounds.span(), problem));
        }
        for scene in &self.scenes {
            if let Some(published) =
                scene.published.iter().find(|p| !(p.frames_per_sec > 0.0 && p.frames_per_sec.is_finite()))
            {
                let problem = format!("published `{}`: frames_per_sec must be positive and finite", published.method);
                return Err(self.error_at(scene.name.span(), problem));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const SMALL: &str = "name = \"small\"\nclaim = \"none\"\n[truth]\nsamples = 8\n[[scene]]\nname = \"vases\"\n\
                         [[strategy]]\nname = \"dim\"\nfactor = [0.5, 0.25]\n";

    fn error(text: &str) -> String {
        Experiment::parse(text, Path::new("e.toml")).unwrap_err().to_string()
    }

    #[test]
    fn what_is_left_out_has_a_default() {
        let experiment = Experiment::parse(SMALL, Path::new("e.toml")).unwrap();
        assert_eq!(experiment.frames, [0]);
        assert_eq!(experiment.receivers, [ReceiverKind::Vertices]);
        assert_eq!(experiment.references, [ReferenceKind::Mesh]);
        assert_eq!((experiment.truth.seed, experiment.weights, experiment.classes), (1, Weighting::Area, true));
        assert!(experiment.timing.is_none() && experiment.pictures.is_none());
    }

    #[test]
    fn mistakes_name_file_and_line() {
        let unknown = error(&SMALL.replace("samples", "sample"));
        assert!(unknown.starts_with("e.toml:4:1: unknown key `sample` (did you mean `samples`?)"), "{unknown}");
        let zero = error(&SMALL.replace("samples = 8", "samples = 0"));
        assert!(zero.starts_with("e.toml:4:11: "), "{zero}");
        let reference = error(&SMALL.replace("[truth]", "references = [\"cubes\"]\n[truth]"));
        assert!(reference.starts_with("e.toml:3:") && reference.contains("known: mesh, spheres"), "{reference}");
        let syntax = error("name = \n");
        assert!(syntax.starts_with("e.toml:1:"), "{syntax}");
        let weights = error(&SMALL.replace("[truth]", "weights = \"mass\"\n[truth]"));
        assert!(
            weights.starts_with("e.toml:3:11: unknown weights `mass`") && weights.contains("area, equal"),
            "{weights}"
        );
        assert!(error(&SMALL.replace("samples = 8", "")).contains("either `samples` or `relative_noise`"));
        let bounds = SMALL.replace(
            "[truth]",
            "stability = { worst_error = 0.5, negative_share = nan, energy_gained = 0, jump = 0.1 }\n[truth]",
        );
        let bounds = error(&bounds);
        assert!(bounds.starts_with("e.toml:3:") && bounds.contains("negative_share must be finite"), "{bounds}");
        for samples in ["samples = 4000000000", "samples = 4e9", "relative_noise = 0", "relative_noise = nan"] {
            let absurd = error(&SMALL.replace("samples = 8", samples));
            assert!(absurd.starts_with("e.toml:4:"), "{samples}: {absurd}");
        }
        for name in ["../small", "", ".hidden", "end.", "nul", "Con.x", "a b", &"a".repeat(260)] {
            let error = error(&SMALL.replace("\"small\"", &format!("{name:?}")));
            assert!(error.starts_with("e.toml:1:8: ") && error.contains("folder"), "{name}: {error}");
        }
        let speed = SMALL.replace(
            "[[strategy]]",
            "[[scene.published]]\nmethod = \"m\"\nhardware = \"h\"\nsource = \"s\"\nframes_per_sec = -1.0\n[[strategy]]",
        );
        assert!(error(&speed).starts_with("e.toml:6:8: "), "{}", error(&speed));
        let speed = speed.replace("-1.0", "inf");
        assert!(error(&speed).starts_with("e.toml:6:8: "), "{}", error(&speed));
    }

    #[test]
    fn lists_that_name_something_twice_are_refused_at_their_line() {
        for list in [
            "frames = [0, 1, 0]",
            "frames = []",
            "receivers = [\"vertices\", \"vertices\"]",
            "references = [\"mesh\", \"bands=4\", \"bands=4\"]",
        ] {
            let error = error(&SMALL.replace("[truth]", &format!("{list}\n[truth]")));
            assert!(
                error.starts_with("e.toml:3:") && (error.contains(": name ") || error.contains("; name ")),
                "{list}: {error}"
            );
        }
        let error = error(&SMALL.replace("[[strategy]]", "frames = [7, 7]\n[[strategy]]"));
        assert!(error.starts_with("e.toml:7:10: entry 2 of the list is there already"), "{error}");
    }

    #[test]
    fn absurd_numbers_are_refused_at_their_line() {
        for lines in [
            "[timing]\nwarm_up = 1\nrepeats = 1000000000",
            "[timing]\nwarm_up = 4000000000\nrepeats = 1",
            "[timing]\nwarm_up = 1\nrepeats = 1\nthreads = 100000",
            "[pictures]\nresolution = [16384, 16384]",
            "[pictures]\nresolution = [4000000000, 1]",
            "[pictures]\nresolution = [0, 1]",
            "[timing]\nwarm_up = 1\nrepeats = 0",
            "[timing]\nwarm_up = 1\nrepeats = 1\nthreads = 0",
        ] {
            let error = error(&SMALL.replace("[[scene]]", &format!("{lines}\n[[scene]]")));
            assert!(
                error.starts_with("e.toml:") && (error.contains("at most") || error.contains("must be from")),
                "{lines}: {error}"
            );
        }
        let error = error(&SMALL.replace("[[strategy]]", "spheres = 1000000000\n[[strategy]]"));
        assert!(error.starts_with("e.toml:7:11: `spheres` = 1000000000 must be from 1 to 100000"), "{error}");
    }
}
