//! State that commands share.

use crate::{
    band_limit,
    cli::{GlobalArguments, SceneArguments},
    failure::Failure,
    progress::{ToldProgress, Verbosity},
    revision::REVISION,
    strategies::strategies,
};
use halfshade_gpu::{Choice, Gpu};
use halfshade_harness::{
    Device, GraphicsDevice, SystemClock,
    output::{check_no_input, check_writable},
    run::Tools,
    scene_source,
};
use halfshade_scene::{Progress, Scene, cache::Cache, input, scene::MAX_BOUNCES};
use halfshade_strategy::Strategy;
use std::{ffi::OsString, path::Path};

/// The machinery that every command works with.
pub(super) struct Context {
    pub(super) cache: Cache,
    pub(super) threads: Option<usize>,
    pub(super) bars: ToldProgress,
    pub(super) clock: SystemClock,
    pub(super) strategies: Vec<Box<dyn Strategy>>,
    /// Graphics device that is wanted, if it was said.
    gpu: Option<Choice>,
    pub(super) revision: &'static str,
    /// The command as it was given.
    pub(super) arguments: Vec<OsString>,
}

impl Context {
    /// State at the start of a command that was given these `arguments`.
    pub(super) fn new(
        global: GlobalArguments,
        arguments: Vec<OsString>,
        more: impl FnOnce(&Cache) -> Vec<Box<dyn Strategy>>,
    ) -> Self {
        let GlobalArguments { cache, threads, gpu, quiet, verbose } = global;
        let cache = Cache::open(cache);
        let mut strategies = strategies(&cache);
        strategies.extend(more(&cache));
        let verbosity = match (quiet, verbose) {
            (true, _) => Verbosity::Quiet,
            (false, true) => Verbosity::Verbose,
            (false, false) => Verbosity::Usual,
        };
        Self {
            threads,
            bars: ToldProgress::new(verbosity),
            clock: SystemClock::start(),
            strategies,
            cache,
            gpu,
            revision: REVISION,
            arguments,
        }
    }

    /// Strategies as they are `named`; all of them, as they are by default, if none is.
    pub(super) fn named_or_all(&self, named: &[String]) -> Vec<String> {
        let all = || self.strategies.iter().map(|strategy| strategy.info().name.to_owned()).collect();
        if named.is_empty() { all() } else { named.to_vec() }
    }

    /// The graphics device of that name, or the one that the user wants.
    pub(super) fn graphics(&self, name: Option<&str>) -> Result<GraphicsDevice, Failure> {
        let of_variable = || std::env::var("HALFSHADE_GPU").unwrap_or_default().parse().unwrap_or_default();
        let choice = name.map(|name| Choice::Name(name.to_owned())).or_else(|| self.gpu.clone());
        let choice = choice.unwrap_or_else(of_variable);
        let gpu = Gpu::open(&choice).map_err(|error| Failure::Error(error.to_string()))?;
        let off =
            || Failure::Error("device `gpu` is asked for, but `--gpu off` or HALFSHADE_GPU=off forbids it".into());
        let gpu = gpu.ok_or_else(off)?;
        let facts = gpu.facts();
        let kind = if facts.is_software { ", in software on the processor" } else { "" };
        let description = format!("{}, {}{kind}", facts.name, facts.driver);
        Ok(GraphicsDevice { description, strategies: halfshade_gpu::strategies(&gpu, &self.cache) })
    }

    /// The graphics device, if any of `devices` is one.
    pub(super) fn graphics_for(
        &self,
        devices: &[Device],
        name: Option<&str>,
    ) -> Result<Option<GraphicsDevice>, Failure> {
        devices.contains(&Device::Gpu).then(|| self.graphics(name)).transpose()
    }

    /// Calls `work` with what the harness needs.
    pub(super) fn with_tools<T>(&self, graphics: Option<&GraphicsDevice>, work: impl FnOnce(&Tools<'_>) -> T) -> T {
        work(&Tools {
            strategies: &self.strategies,
            graphics,
            band_limit: &band_limit,
            cache: &self.cache,
            progress: &self.bars,
            clock: &self.clock,
            revision: self.revision,
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
        if arguments.still {
            // Whatever frame is asked of it: it is that one.
            scene = scene.still_at(arguments.frame);
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
