//! The trait, in three phases with three clocks, so that nobody hides work.

use crate::{Info, Params};
use halfshade_scene::{Frame, Progress, RadianceMut, Receivers, Scene};

/// Why a strategy could not do what it was asked.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StrategyError {
    /// It cannot model this scene; the reason is shown in the table.
    #[error("unsupported: {0}")]
    Unsupported(String),
    /// Something went wrong.
    #[error("{0}")]
    Failed(String),
}

/// A method under comparison.
pub trait Strategy: Send + Sync {
    /// Name, parameters, effects.
    fn info(&self) -> Info;

    /// Whether it reads the objects' sphere sets; building them for those who don't would be a wait for nothing.
    fn needs_spheres(&self) -> bool {
        true
    }

    /// Offline, once per scene: tables and fields that hold for every frame. `params` holds a value for every parameter
    /// of [`Info::parameters`], within its range.
    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError>;
}

/// A strategy made ready for one scene.
pub trait Baked: Send + Sync {
    /// Bytes held, by part; those of the last frame that was prepared among them.
    fn footprint(&self) -> Footprint;

    /// Figures on what was baked that only this strategy has, such as the resolution it chose; found when asked for, off
    /// every clock.
    fn details(&self) -> Vec<Detail> {
        Vec::new()
    }

    /// Tells which receivers all calls to come are for, as they are in `frame`: once, off every clock, before the first frame
    /// is prepared. Who runs on a device with memory of its own puts there what stays the same from frame to frame.
    fn place_receivers(&mut self, _frame: &Frame<'_>, _receivers: Receivers<'_>) -> Result<(), StrategyError> {
        Ok(())
    }

    /// Once per frame: poses, lights. Calling it twice with the same frame changes nothing.
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError>;
}

/// A strategy made ready for one frame: who hasn't prepared can't shade.
pub trait Prepared: Send + Sync {
    /// How the receivers may be split.
    fn batching(&self) -> Batching {
        Batching::AnySplit
    }

    /// Outgoing RGB radiance of a batch of receivers, toward the eye:
    /// `albedo/π · ∫ L V max(n·ω, 0) dω`, and the same over the lobes of glossy receivers ([`halfshade_scene::EyeLobes`]).
    /// Called from many threads at once on parts of the receivers, unless [`Self::batching`] asks for all of them. Allocates
    /// nothing per receiver.
    /// Radiance on a device with memory of its own stays there until [`Self::read_back`].
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>);

    /// Begins to shade all receivers on a device that works by itself, so that the next frame can be prepared meanwhile; `None`
    /// where [`Self::shade`] does the work before it returns.
    fn start(&self, _receivers: Receivers<'_>) -> Option<Result<Box<dyn Shading>, StrategyError>> {
        None
    }

    /// Copies what was shaded last from a device with memory of its own, and tells what went wrong there.
    fn read_back(&self, _out: RadianceMut<'_>) -> Result<(), StrategyError> {
        Ok(())
    }

    /// Seconds that the last [`Self::shade`] took by the clock of such a device.
    fn device_secs(&self) -> Option<f64> {
        None
    }
}

/// A frame that a device is shading.
pub trait Shading {
    /// Waits for its end.
    fn finish(self: Box<Self>) -> Result<(), StrategyError>;
}

/// How the receivers of a frame may be split into batches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Batching {
    /// Any way: how they are split changes no bit.
    AnySplit,
    /// Not at all: one call has all receivers of the frame. For filters, which look at a receiver's neighbours, and for
    /// graphics hardware; threads are then the strategy's own to fill.
    WholeFrame,
}

/// A list of figures under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Detail {
    /// Name of the figures, with their unit.
    pub name: String,
    /// The figures, in an order that the name tells.
    pub values: Vec<f64>,
}

/// Bytes by part.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Part name and its bytes.
    pub parts: Vec<(&'static str, usize)>,
}

impl Footprint {
    /// Sum over the parts.
    pub fn bytes(&self) -> usize {
        self.parts.iter().map(|(_, bytes)| bytes).sum()
    }
}
