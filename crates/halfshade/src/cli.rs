//! The arguments: a contract, extended but not broken.

mod choices;
mod comparison;
mod count;
mod files;
mod global;
mod shell;

pub(crate) use choices::{DeviceArgument, ReceiverChoice};
pub(crate) use comparison::{CompareArguments, TuneArguments};
pub(crate) use files::{FileChoice, NewArguments, SchemaArguments};
pub(crate) use global::GlobalArguments;
pub(crate) use shell::{CompletionsArguments, ManArguments};

use crate::revision::REVISION;
use clap::{Args, Parser, Subcommand, ValueEnum};
use count::{count, sample_count};
use halfshade_harness::{part::ShardChoice, scene_source::MeshLight};
use halfshade_scene::{
    camera::{MAX_SIDE, check_resolution},
    light::ProbeOptions,
    spheres::MAX_SPHERES,
};
use std::path::PathBuf;

/// Compares real-time methods for soft shadows: error and time of every strategy against ray-traced truth.
#[derive(Debug, Parser)]
#[command(name = "halfshade", version = REVISION, arg_required_else_help = true)]
pub struct Cli {
    /// Arguments of every command.
    #[command(flatten)]
    pub global: GlobalArguments,
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run an experiment: score, time and picture every strategy on every scene.
    Run(RunArguments),
    /// Compare strategies on scenes without an experiment file.
    Compare(CompareArguments),
    /// Join the parts of an experiment that were run apart, by `run --shard` and `run --times`.
    Merge(MergeArguments),
    /// Search strategies and their parameters for the fastest within an error, or the most exact within a frame's time.
    Tune(TuneArguments),
    /// Draw one picture of a scene with one strategy.
    Render(RenderArguments),
    /// Trace the truth alone, with its standard error as a layer.
    Truth(TruthArguments),
    /// Build a sphere set for a mesh and print how well it fits.
    Spheres(SpheresArguments),
    /// Write a frame of a scene for another renderer, with a script that compares its answer with the truth.
    Export(ExportArguments),
    /// List strategies or scenes, with every parameter, default and range.
    List(ListArguments),
    /// Compare an experiment's errors with a baseline: exit status 1 where one grew beyond noise.
    Check(CheckArguments),
    /// Write tables and plots from stored results, with the pictures that lie beside them; or several results side by side.
    Report(ReportArguments),
    /// Write a commented scene or experiment file to begin with.
    New(NewArguments),
    /// Print the keys of scene or experiment files: as JSON Schema for editors, or as tables.
    Schema(SchemaArguments),
    /// Print a script that completes arguments in a shell.
    Completions(CompletionsArguments),
    /// Print a manual page.
    Man(ManArguments),
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Where results go [default: out/NAME].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Fewer samples, one frame per scene, three timed rounds: to see whether it works, not for publication.
    #[arg(long)]
    pub quick: bool,
    /// Go on with a run that was interrupted.
    #[arg(long)]
    pub resume: bool,
    /// Run only these of the experiment's scenes and strategies, by name; without any scene all of them, and without any
    /// strategy.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Measure errors of this share of the runs only: NUMBER/COUNT; `auto` where Slurm tells both, `auto/COUNT` where HyperQueue
    /// or GNU parallel tell the number. `merge` joins them.
    #[arg(long, value_name = "SHARD", conflicts_with = "times")]
    pub shard: Option<ShardChoice>,
    /// Measure times only, which `merge` joins with the errors of shards: on a machine that does nothing else.
    #[arg(long)]
    pub times: bool,
    /// Run on these devices instead of the experiment's: cpu, gpu, or a part of a graphics device's name.
    #[arg(long, value_name = "DEVICE", value_delimiter = ',')]
    pub device: Vec<DeviceArgument>,
}

/// Arguments of `merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Folders of all shards, and of the times, if there are any.
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// Where results go [default: out/NAME].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A scene, and light for it where it is a mesh.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// A scene file, a built-in name, or a mesh file (which stands on a ground plane).
    pub scene: String,
    /// Light of a mesh file: `sky`, `constant`, or an image (.hdr, .exr) [default: sky].
    #[arg(long, value_name = "LIGHT")]
    pub env: Option<String>,
    /// The layer of an OpenEXR image that is the light [default: the one without a name].
    #[arg(long, value_name = "NAME")]
    pub env_layer: Option<String>,
    /// Largest radiance of the image: larger and infinite ones become this, negative ones and what isn't a number 0.
    #[arg(long, value_name = "RADIANCE", value_parser = largest_radiance, allow_negative_numbers = true)]
    pub clamp: Option<f32>,
    /// Frame of the animation.
    #[arg(long, default_value_t = 0)]
    pub frame: usize,
    /// Hold the scene still at that frame, for methods that need one that doesn't move.
    #[arg(long)]
    pub still: bool,
    /// Diffuse bounces of light [default: the scene's, 0 of a mesh].
    #[arg(long, value_name = "N")]
    pub bounces: Option<usize>,
    /// Width and height, such as 640x480 [default: the scene's camera's].
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub resolution: Option<[u32; 2]>,
}

impl SceneArguments {
    /// The light of a mesh file.
    pub fn light(&self) -> MeshLight<'_> {
        MeshLight { name: self.env.as_deref(), layer: self.env_layer.as_deref(), clamp: self.clamp }
    }
}

/// Appearance of a picture.
#[derive(Debug, Args)]
pub struct PictureArguments {
    /// Radiance where nothing is hit: one number, or red,green,blue [default: 0].
    #[arg(long, value_name = "RADIANCE", value_parser = color)]
    pub background: Option<[f32; 3]>,
    /// Exposure of a PNG in stops: radiance times 2^STOPS, the same in every picture [default: automatic, and told].
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = stops)]
    pub exposure: Option<f32>,
}

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The picture.
    #[command(flatten)]
    pub picture: PictureArguments,
    /// The strategy, as `name` or `name:key=value,key=value`.
    #[arg(long, value_name = "SPEC")]
    pub strategy: String,
    /// Shade the pixels themselves, or the vertices and interpolate.
    #[arg(long, value_enum, default_value_t = ReceiverChoice::Pixels)]
    pub receivers: ReceiverChoice,
    /// The device: cpu, gpu, or a part of a graphics device's name.
    #[arg(long, value_name = "DEVICE", default_value = "cpu")]
    pub device: DeviceArgument,
    /// Trace the truth too, and print the error; an .exr gets the layers `truth` and `error`.
    #[arg(long)]
    pub truth: bool,
    /// Samples of that truth per receiver.
    #[arg(long, default_value_t = 256, value_parser = sample_count)]
    pub samples: usize,
    /// The picture, .exr or .png [default: SCENE.exr].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `truth`.
#[derive(Debug, Args)]
pub struct TruthArguments {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The picture.
    #[command(flatten)]
    pub picture: PictureArguments,
    /// Samples per pixel and kind of light.
    #[arg(long, default_value_t = 256, value_parser = sample_count)]
    pub samples: usize,
    /// Where the samples start from.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The picture, .exr (result and layer `stderr`) or .png [default: SCENE-truth.exr].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The renderer.
    #[arg(long, value_enum)]
    pub format: ExportChoice,
    /// A new folder for the scene and all that belongs to it [default: SCENE-FORMAT].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Renderers that scenes are written for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportChoice {
    /// Mitsuba 3.
    Mitsuba,
}

/// Arguments of `spheres`.
#[derive(Debug, Args)]
pub struct SpheresArguments {
    /// The mesh file: .obj, .ply, .gltf, .glb.
    pub mesh: PathBuf,
    /// How many spheres, at most 2000.
    #[arg(short = 'n', long, value_name = "COUNT", value_parser = sphere_count)]
    pub count: usize,
    /// Aim of the fit.
    #[arg(long, value_enum, default_value_t = FitChoice::Shadow)]
    pub fit: FitChoice,
    /// Write the set as JSON.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Aims of sphere sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FitChoice {
    /// Every point of the surface in a sphere, with little volume outside.
    Bounding,
    /// As much light as the mesh leaves, on the ground and on the object.
    Shadow,
}

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct ListArguments {
    /// Kind of thing to list.
    #[arg(value_enum)]
    pub what: ListChoice,
    /// For programs.
    #[arg(long)]
    pub json: bool,
}

/// Kinds of things that can be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ListChoice {
    /// The strategies.
    Strategies,
    /// The built-in scenes.
    Scenes,
    /// Graphics devices.
    Devices,
    /// Kernels for graphics devices, their twins on the processor, and what has none.
    Kernels,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The experiment file.
    pub experiment: PathBuf,
    /// A `results.json` to compare with.
    #[arg(long, value_name = "FILE")]
    pub baseline: PathBuf,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// The folder of the results; of several, what moved between the first and the others.
    #[arg(required = true, value_name = "FOLDER")]
    pub folders: Vec<PathBuf>,
    /// In which format.
    #[arg(long, value_enum, default_value_t = FormatChoice::Md)]
    pub format: FormatChoice,
    /// Write it to this file instead of the standard output; its links start from the folder of the results.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Formats of reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormatChoice {
    /// Markdown.
    Md,
    /// Every number of every run.
    Csv,
    /// LaTeX tables with booktabs.
    Latex,
    /// One page.
    Html,
    /// Aligned columns, without marks.
    Text,
}

fn resolution(text: &str) -> Result<[u32; 2], String> {
    let size = text
        .split_once(['x', 'X'])
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]))
        .ok_or_else(|| format!("expected WIDTHxHEIGHT such as 640x480, each from 1 to {MAX_SIDE}"))?;
    check_resolution(size).map(|()| size)
}

fn sphere_count(text: &str) -> Result<usize, String> {
    count(text, MAX_SPHERES)
}

fn stops(text: &str) -> Result<f32, String> {
    /// More than the range of any picture.
    const LARGEST: f32 = 64.0;
    let stops = text.parse().ok().filter(|stops| (-LARGEST..=LARGEST).contains(stops));
    stops.ok_or_else(|| format!("expected a number from -{LARGEST} to {LARGEST}"))
}

fn largest_radiance(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|clamp| ProbeOptions::is_clamp(*clamp));
    number.ok_or_else(|| "expected a number, positive and finite".into())
}

fn color(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f32| x.is_finite() && *x >= 0.0)).collect();
    match numbers.as_deref() {
        Some([grey]) => Ok([*grey; 3]),
        Some(&[r, g, b]) => Ok([r, g, b]),
        _ => Err("expected one number or three with commas, finite and not negative".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::{count::thread_count, *};
    use halfshade_truth::MAX_SAMPLES;

    #[test]
    fn the_arguments_are_consistent() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
        assert_eq!(resolution("640x480"), Ok([640, 480]));
        assert!(resolution("0x480").is_err() && resolution("640").is_err() && resolution("99999x1").is_err());
        assert!(resolution("16384x16384").unwrap_err().contains("pixels in all"));
        assert!(resolution("7680x4320").is_ok() && resolution("16384x1").is_ok());
        for absurd in ["0", "1025", "-1", "18446744073709551616", "many"] {
            assert!(thread_count(absurd).is_err(), "{absurd}");
        }
        assert_eq!(thread_count("1024"), Ok(1024));
        assert_eq!(sample_count("0"), Err(format!("expected a whole number from 1 to {MAX_SAMPLES}")));
        assert_eq!((sphere_count("1"), sphere_count("2000")), (Ok(1), Ok(2000)));
        assert!(sphere_count("0").is_err() && sphere_count("2001").is_err());
        for absurd in ["nan", "inf", "-inf", "1e9", "-64.5", "bright"] {
            assert!(stops(absurd).is_err(), "{absurd}");
        }
        assert_eq!(stops("-2.5"), Ok(-2.5));
        assert_eq!(largest_radiance("65504"), Ok(65504.0));
        for bad in ["0", "-1", "nan", "inf", "1e39", "one", ""] {
            assert!(largest_radiance(bad).is_err(), "{bad}");
        }
        assert_eq!(color("0.5"), Ok([0.5; 3]));
        assert_eq!(color("1, 2,3"), Ok([1.0, 2.0, 3.0]));
        assert!(color("nan").is_err() && color("1,2").is_err() && color("-1").is_err());
    }
}
