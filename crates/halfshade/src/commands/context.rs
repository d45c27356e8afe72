//! State that commands share.

use crate::{
    band_limit, cli::SceneArguments, failure::Failure, revision::revision, strategies::strategies,
    terminal::ProgressBars,
};
use halfshade_harness::{
    SystemClock,
    output::{check_no_input, check_writable},
    run::Tools,
    scene_source,
};
use halfshade_scene::{Progress, Scene, cache::Cache, input, scene::MAX_BOUNCES};
use halfshade_strategy::Strategy;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// The machinery that every command works with.
pub(super) struct Context {
    pub(super) cache: Cache,
    pub(super) threads: Option<usize>,
    pub(super) bars: ProgressBars,
    pub(super) clock: SystemClock,
    pub(super) strategies: Vec<Box<dyn Strategy>>,
    revision: String,
    /// The command as it was given.
    pub(super) arguments: Vec<OsString>,
}

impl Context {
    /// State at the start of a command that was given these `arguments`.
    pub(super) fn new(cache: Option<PathBuf>, threads: Option<usize>, arguments: Vec<OsString>) -> Self {
        let cache = Cache::open(cache);
        Self {
            threads,
            bars: ProgressBars::new(),
            clock: SystemClock::start(),
            strategies: strategies(&cache),
            cache,
            revision: revision(),
            arguments,
        }
    }

    /// Calls `work` with what the harness needs.
    pub(super) fn with_tools<T>(&self, work: impl FnOnce(&Tools<'_>) -> T) -> T {
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
    pub(super) fn scene(&self, arguments: &SceneArguments, output: &Path) -> Result<Scene, Failure> {
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

    /// Checks that `output` can be written, and says so if that replaces a file.
    pub(super) fn prepare_output(&self, output: &Path) -> Result<(), Failure> {
        if check_writable(output)? {
            self.bars.note(&format!("{} is there already and will be replaced", output.display()));
        }
        Ok(())
    }
}
