//! Experiment files: which scenes, which strategies, which truth, how timed, what pictured.
//!
//! ```toml
//! name = "soft-shadows"
//! claim = "what the experiment tests, in a sentence"
//! frames = [0]                       # default [0]; a scene may have its own
//! devices = ["cpu"]                  # and/or "gpu": the graphics device; default cpu
//! receivers = ["vertices"]           # and/or "pixels"; default vertices
//! references = ["mesh", "spheres", "bands"]   # default ["mesh"]; see `ReferenceKind`
//! weights = "area"                   # vertices count by the area around them; or "equal": all alike. Default area
//! classes = true                     # error by class of what hides the light at a receiver; default true
//! details = true                     # also what only one strategy tells, such as the resolution it chose; default false
//! stability = { worst_error = 0.5, negative_share = 0.01, energy_gained = 0.01, jump = 0.1 }   # bounds on how strategies behave, for
//! #                                  # a table that says where they hold; see `stability`. Default none
//! stages = false                     # also the error taken apart: each stage of a method made exact in turn; default false
//! baseline = "A"                     # a SPEC that verdicts compare all others with; default what errs least
//! compare = [["A", "B"]]             # pairs of SPECs that are compared with each other too; default none
//!
//! [truth]
//! samples = 1024                     # per receiver; or relative_noise = 0.002 (of the unshadowed mean)
//! seed = 1
//!
//! [timing]                           # leave it out to measure no time
//! warm_up = 2
//! repeats = 11
//! threads = 2                        # default: all
//!
//! [pictures]                         # leave it out to draw none
//! resolution = [480, 360]            # default: the camera's
//! strategies = ["sh-exp:exp=hybrid"] # default: all
//! difference = ["A", "B"]            # two SPECs whose difference, times ten, is a picture too
//!
//! [[scene]]
//! name = "vases"                     # built-in, or a scene or mesh file relative to this file
//! still = 60                         # the scene held still as it is at that frame, for methods that need one that doesn't move
//! bounces = 1                        # diffuse bounces of light, if other than the scene's own
//! spheres = 64                       # leaf spheres in all, shared out among the objects as the scene's own are
//! fit = "shadow"                     # or "bounding": what all sphere sets are fitted to, if other than the scene's own
//! camera = { eye = [0, 1, 4], target = [0, 0.5, 0], vertical_fov_degrees = 20 }   # another view, such as a close-up
//! sweep = { spheres = [10, 20], bounces = [0, 1] }   # every combination, each a scene of its own. Keys are those above, but for
//!                                    # frames, receivers, camera; or, where it is a scene file, paths into that:
//!                                    # "light.1.radiance", "object.bunny.albedo", "environment.sky.turbidity"
//! [[scene.published]]
//! method = "Ren et al. pixel shader"
//! hardware = "GeForce 8800 GTX"
//! source = "[Guerrero2007, 6]"
//! frames_per_sec = 95
//!
//! [[strategy]]
//! name = "sh-exp"
//! exp = ["series", "hybrid"]         # a list sweeps; several lists: every combination
//! bands = [2, 3, 4]
//! ```

mod compose;
mod fields;
mod kinds;
mod only;
mod scene_sweep;

pub use compose::Comparison;
pub use kinds::{ReceiverKind, ReferenceKind};
pub use scene_sweep::Sweep;

use crate::{Device, HarnessError, Weighting, stability::StabilityFigures};
use halfshade_scene::{SphereFit, file::Change, text};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    num::{NonZeroU32, NonZeroUsize},
    path::{Path, PathBuf},
};
use toml::Spanned;

/// A whole experiment, as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Short name: of the output folder, of tables.
    #[serde(deserialize_with = "fields::folder_name")]
    pub name: String,
    /// The claim it tests.
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
    /// References that strategies are compared with.
    #[serde(default = "mesh_only", deserialize_with = "fields::distinct")]
    pub references: Vec<ReferenceKind>,
    /// Weights of vertices.
    #[serde(default = "area")]
    pub weights: Weighting,
    /// Whether errors are told by class of what hides the light at a receiver.
    #[serde(default = "yes")]
    pub classes: bool,
    /// Whether strategies are asked for figures that only they have.
    #[serde(default)]
    pub details: bool,
    /// Bounds on how strategies behave at extremes, if they are to be told.
    pub stability: Option<Spanned<StabilityFigures>>,
    /// Whether errors are taken apart by the stages of each method.
    #[serde(default)]
    pub stages: bool,
    /// SPEC of the strategy that verdicts compare all others with.
    pub baseline: Option<Spanned<String>>,
    /// Pairs of SPECs that are compared with each other.
    #[serde(default)]
    pub compare: Vec<[Spanned<String>; 2]>,
    /// How exact the truth is.
    pub truth: TruthSettings,
    /// How time is measured, if it is.
    pub timing: Option<TimingSettings>,
    /// Pictures to draw, if any.
    pub pictures: Option<PictureSettings>,
    /// The scenes.
    #[serde(rename = "scene")]
    pub scenes: Vec<SceneEntry>,
    /// The strategies and their sweeps: the key `name` and any parameters.
    #[serde(rename = "strategy")]
    pub strategies: Vec<Spanned<BTreeMap<String, Spanned<toml::Value>>>>,
    /// Names of the scenes and strategies that are kept of the file, if not all are.
    #[serde(skip)]
    pub only: Vec<String>,
    /// The file that it was read from; empty if there is none.
    #[serde(skip)]
    pub path: PathBuf,
    /// Its text, for line numbers and for the hash that resuming compares.
    #[serde(skip)]
    pub text: String,
}

/// One scene of an experiment.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneEntry {
    /// A built-in name, or a file relative to the experiment.
    pub name: Spanned<String>,
    /// Light for a mesh file: `sky`, `constant` or an image; must be left out otherwise. The scene's name says which.
    pub environment: Option<String>,
    /// The frame at which the scene is held still; then its name says so, and it has frame 0 alone.
    pub still: Option<Spanned<usize>>,
    /// Frames, if other than the experiment's.
    #[serde(default, deserialize_with = "fields::some_distinct")]
    pub frames: Option<Vec<usize>>,
    /// Points that are scored, if other than the experiment's.
    #[serde(default, deserialize_with = "fields::some_distinct")]
    pub receivers: Option<Vec<ReceiverKind>>,
    /// Diffuse bounces of light, if other than the scene's.
    pub bounces: Option<Spanned<usize>>,
    /// Width and height of the camera's picture, if other than the scene's; then the scene's name says so.
    #[serde(default, deserialize_with = "fields::picture_size")]
    pub resolution: Option<[u32; 2]>,
    /// Another view for pictures.
    pub camera: Option<Spanned<View>>,
    /// Leaf spheres in all, if other than the scene's; then the scene's name says so.
    #[serde(default, deserialize_with = "fields::sphere_count")]
    pub spheres: Option<NonZeroUsize>,
    /// Aim of all sphere sets, if other than the scene's; then the scene's name says so.
    pub fit: Option<SphereFit>,
    /// Values of other keys, or of paths into the scene file, each of which is run: key and list.
    #[serde(default, deserialize_with = "scene_sweep::lists")]
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
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Eye in world space.
    pub eye: [f32; 3],
    /// The point looked at.
    pub target: [f32; 3],
    /// Angle spanned by the picture's height, in degrees.
    pub vertical_fov_degrees: f32,
}

/// A frame rate from the literature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// The method, with its authors.
    pub method: String,
    /// Hardware that it ran on.
    pub hardware: String,
    /// Publication that prints it.
    pub source: String,
    /// Frames per second.
    pub frames_per_sec: f64,
}

/// How exact the truth is: give `samples` or `relative_noise`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthSettings {
    /// Samples per receiver.
    #[serde(default, deserialize_with = "fields::sample_count")]
    pub samples: Option<NonZeroU32>,
    /// Sample until the root mean square of the standard error is below this fraction of the unshadowed mean.
    #[serde(default, deserialize_with = "fields::noise")]
    pub relative_noise: Option<f64>,
    /// Seed of the samples.
    #[serde(default = "one")]
    pub seed: u32,
}

/// How time is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimingSettings {
    /// Rounds that are thrown away.
    #[serde(deserialize_with = "fields::round_count")]
    pub warm_up: u32,
    /// Rounds that count.
    #[serde(deserialize_with = "fields::round_count")]
    pub repeats: NonZeroU32,
    /// Frames that a graphics device works on at once in a measurement of their own: how many a second, and how long each takes
    /// from its preparation to its end. None if left out.
    #[serde(default)]
    pub frames_in_flight: Option<NonZeroU32>,
    /// Threads; all if left out. `--threads` wins.
    #[serde(default, deserialize_with = "fields::thread_count")]
    pub threads: Option<NonZeroUsize>,
}

/// Settings of pictures.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureSettings {
    /// Width and height, if other than the camera's.
    #[serde(default, deserialize_with = "fields::picture_size")]
    pub resolution: Option<[u32; 2]>,
    /// SPECs, if not all.
    pub strategies: Option<Vec<Spanned<String>>>,
    /// Two SPECs whose difference is drawn.
    pub difference: Option<[Spanned<String>; 2]>,
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
        let mut experiment: Self = toml::from_str(text).map_err(|error| match error.span() {
            Some(span) => HarnessError::at_line(path, line_of(text, span.start), error.message().trim()),
            None => HarnessError::in_file(path, error.message().trim()),
        })?;
        experiment.path = path.to_owned();
        experiment.text = text.to_owned();
        experiment.validate()?;
        Ok(experiment)
    }

    /// An error at the place `offset` of the file.
    pub fn error_at(&self, offset: usize, problem: impl Into<String>) -> HarnessError {
        if self.path.as_os_str().is_empty() {
            return HarnessError::input(problem);
        }
        HarnessError::at_line(&self.path, line_of(&self.text, offset), problem)
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
            return Err(self.error_at(bounds.span().start, problem));
        }
        for scene in &self.scenes {
            if let Some(published) =
                scene.published.iter().find(|p| !(p.frames_per_sec > 0.0 && p.frames_per_sec.is_finite()))
            {
                let problem = format!("published `{}`: frames_per_sec must be positive and finite", published.method);
                return Err(self.error_at(scene.name.span().start, problem));
            }
        }
        Ok(())
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|&byte| byte == b'\n').count() + 1
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
        assert!(unknown.starts_with("e.toml:4: ") && unknown.contains("unknown field `sample`"), "{unknown}");
        let zero = error(&SMALL.replace("samples = 8", "samples = 0"));
        assert!(zero.starts_with("e.toml:4: "), "{zero}");
        let reference = error(&SMALL.replace("[truth]", "references = [\"cubes\"]\n[truth]"));
        assert!(reference.starts_with("e.toml:3: ") && reference.contains("known: mesh, spheres"), "{reference}");
        let syntax = error("name = \n");
        assert!(syntax.starts_with("e.toml:1: "), "{syntax}");
        let weights = error(&SMALL.replace("[truth]", "weights = \"mass\"\n[truth]"));
        assert!(weights.starts_with("e.toml:3: ") && weights.contains("`area` or `equal`"), "{weights}");
        assert!(error(&SMALL.replace("samples = 8", "")).contains("either `samples` or `relative_noise`"));
        let bounds = SMALL.replace(
            "[truth]",
            "stability = { worst_error = 0.5, negative_share = nan, energy_gained = 0, jump = 0.1 }\n[truth]",
        );
        let bounds = error(&bounds);
        assert!(bounds.starts_with("e.toml:3: ") && bounds.contains("negative_share must be finite"), "{bounds}");
        for samples in ["samples = 4000000000", "samples = 4e9", "relative_noise = 0", "relative_noise = nan"] {
            let absurd = error(&SMALL.replace("samples = 8", samples));
            assert!(absurd.starts_with("e.toml:4: "), "{samples}: {absurd}");
        }
        for name in ["../small", "", ".hidden", "end.", "nul", "Con.x", "a b", &"a".repeat(260)] {
            let error = error(&SMALL.replace("\"small\"", &format!("{name:?}")));
            assert!(error.starts_with("e.toml:1: ") && error.contains("folder"), "{name}: {error}");
        }
        let speed = SMALL.replace(
            "[[strategy]]",
            "[[scene.published]]\nmethod = \"m\"\nhardware = \"h\"\nsource = \"s\"\nframes_per_sec = -1.0\n[[strategy]]",
        );
        assert!(error(&speed).starts_with("e.toml:6: "), "{}", error(&speed));
        let speed = speed.replace("-1.0", "inf");
        assert!(error(&speed).starts_with("e.toml:6: "), "{}", error(&speed));
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
                error.starts_with("e.toml:3: ") && (error.contains(": name ") || error.contains("; name ")),
                "{list}: {error}"
            );
        }
        let error = error(&SMALL.replace("[[strategy]]", "frames = [7, 7]\n[[strategy]]"));
        assert!(error.starts_with("e.toml:7: entry 2 of the list is there already"), "{error}");
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
                error.starts_with("e.toml:") && (error.contains("at most") || error.contains("from 1 to")),
                "{lines}: {error}"
            );
        }
        let error = error(&SMALL.replace("[[strategy]]", "spheres = 1000000000\n[[strategy]]"));
        assert!(error.starts_with("e.toml:7: expected a whole number of spheres from 1 to "), "{error}");
    }
}
