//! One file per command.

mod check;
mod list;
mod render;
mod report;
mod run;
mod spheres;
mod truth;

use crate::{
    band_limit,
    cli::{Cli, Command, SceneArguments},
    revision, strategies,
    terminal::Bars,
};
use glam::Vec3;
use halfshade_harness::{
    HarnessError, Picture, SystemClock,
    output::{check_no_input, check_writable},
    run::Tools,
    scene_source,
};
use halfshade_scene::{Progress, Scene, SceneError, cache::Cache, input, scene::MAX_BOUNCES};
use halfshade_strategy::Strategy;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Why a command ended early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad usage or input.
    Error(String),
    /// Nobody reads the output any more.
    ClosedPipe,
}

impl From<HarnessError> for Failure {
    fn from(error: HarnessError) -> Self {
        Self::Error(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Error(error.to_string())
    }
}

/// What commands share.
pub(crate) struct Context {
    cache: Cache,
    threads: Option<usize>,
    bars: Bars,
    clock: SystemClock,
    strategies: Vec<Box<dyn Strategy>>,
    revision: String,
    /// The command as it was given.
    arguments: Vec<OsString>,
}

impl Context {
    /// Calls `work` with what the harness needs.
    fn with_tools<T>(&self, work: impl FnOnce(&Tools<'_>) -> T) -> T {
        work(&Tools {
            strategies: &self.strategies,
            band_limit: &band_limit,
            cache: &self.cache,
            progress: &self.bars,
            clock: &self.clock,
            revision: &self.revision,
        })
    }

    /// The scene, its sphere sets not yet built, for a picture that goes to `output`.
    fn scene(&self, arguments: &SceneArguments, output: &Path) -> Result<Scene, Failure> {
        let (scene, inputs) =
            input::recorded(|| scene_source::resolve(&arguments.scene, Path::new(""), &arguments.light()));
        let mut scene = scene?;
        check_no_input(output, &inputs)?;
        scene.notes.iter().for_each(|note| self.bars.note(note));
        if arguments.frame >= scene.frame_count.max(1) {
            return Err(Failure::Error(format!(
                "scene `{}` has {} frames: there is no frame {}",
                scene.name, scene.frame_count, arguments.frame
            )));
        }
        scene.bounces = arguments.bounces.unwrap_or(scene.bounces);
        if scene.bounces > MAX_BOUNCES {
            return Err(Failure::Error(format!("--bounces {}: at most {MAX_BOUNCES}", scene.bounces)));
        }
        scene.camera.resolution = arguments.resolution.unwrap_or(scene.camera.resolution);
        Ok(scene)
    }
}

fn background(arguments: &SceneArguments) -> Vec3 {
    arguments.background.map_or(Vec3::ZERO, Vec3::from)
}

fn exposure(picture: &Picture, arguments: &SceneArguments) -> f32 {
    picture.exposure() * arguments.exposure.exp2()
}

/// Checks that `output` can be written, and says so if that replaces a file.
fn prepare_output(context: &Context, output: &Path) -> Result<(), Failure> {
    if check_writable(output)? {
        context.bars.note(&format!("{} is there already and will be replaced", output.display()));
    }
    Ok(())
}

/// A picture in which nothing is to be seen would pass for one of a dark scene.
fn sees_nothing(scene: &Scene) -> Failure {
    let [width, height] = scene.camera.resolution;
    Failure::Error(format!(
        "the camera of scene `{}` sees nothing: no ray of {width}x{height} pixels meets an object; move or turn it, or give \
         more pixels",
        scene.name
    ))
}

/// A file named after the scene, in the current folder.
fn default_output(arguments: &SceneArguments, suffix: &str) -> PathBuf {
    let stem = Path::new(&arguments.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    PathBuf::from(format!("{stem}{suffix}"))
}

/// Does what was asked.
pub(crate) fn dispatch(cli: Cli, arguments: Vec<OsString>) -> Result<ExitCode, Failure> {
    let cache = Cache::open(cli.cache);
    let context = Context {
        threads: cli.threads,
        bars: Bars::new(),
        clock: SystemClock::start(),
        strategies: strategies(&cache),
        cache,
        revision: revision(),
        arguments,
    };
    match cli.command {
        Command::Run(arguments) => run::run(&context, &arguments),
        Command::Check(arguments) => check::check(&context, &arguments),
        Command::List(arguments) => list::list(&context, &arguments),
        Command::Report(arguments) => report::report(&context, &arguments),
        Command::Render(arguments) => on_threads(&context, || render::render(&context, &arguments)),
        Command::Truth(arguments) => on_threads(&context, || truth::truth(&context, &arguments)),
        Command::Spheres(arguments) => on_threads(&context, || spheres::spheres(&context, &arguments)),
    }
}

fn on_threads<T: Send>(context: &Context, work: impl FnOnce() -> Result<T, Failure> + Send) -> Result<T, Failure> {
    halfshade_harness::threads::with_threads(context.threads, work)?
}
