//! Strategies, clock, cache and progress of a run.

use crate::{Clock, Device, GraphicsDevice, Part, Variant, reference::BandLimit};
use halfshade_scene::{InputFile, Progress, cache::Cache};
use halfshade_strategy::Strategy;
use std::path::PathBuf;

/// Everything that the harness gets from its caller: it names no strategy and owns no terminal.
pub struct Tools<'a> {
    /// All strategies.
    pub strategies: &'a [Box<dyn Strategy>],
    /// The graphics device, if there is one.
    pub graphics: Option<&'a GraphicsDevice>,
    /// Limits an environment to some bands.
    pub band_limit: &'a BandLimit<'a>,
    /// Cache of sphere sets.
    pub cache: &'a Cache,
    /// Receiver of progress.
    pub progress: &'a dyn Progress,
    /// The clock.
    pub clock: &'a dyn Clock,
    /// Version and commit of the program.
    pub revision: &'a str,
}

impl Tools<'_> {
    /// The strategy of a variant on its device, if it has kernels there.
    pub(crate) fn strategy(&self, variant: &Variant) -> Option<&dyn Strategy> {
        match variant.device {
            Device::Cpu => self.strategies.get(variant.strategy).map(Box::as_ref),
            Device::Gpu => self.graphics?.strategy(&variant.name),
        }
    }
}

/// How an experiment is run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Threads, if other than the experiment's.
    pub threads: Option<usize>,
    /// Devices, if others than the experiment's.
    pub devices: Option<Vec<Device>>,
    /// The part of the experiment that is run.
    pub part: Part,
    /// Fewer samples, one frame, three timed rounds.
    pub quick: bool,
    /// Go on with the journal that is there.
    pub resume: bool,
    /// Folder of pictures, results and the journal; without it nothing is written, timed or pictured.
    pub out: Option<PathBuf>,
    /// Refuse scenes that are read from other files than these.
    pub inputs: Option<Vec<InputFile>>,
}
