//! Settings and frame as plain arrays, for kernels that run elsewhere than on the processor.

pub use crate::shared::{
    blockers::BlockingSphere,
    placed_lamps::{Lamp, LampPlace},
};

use super::{BakedScene, settings::Own};
use crate::shared::irradiance::Irradiance;
use glam::{DMat3, DVec3};
use halfshade_scene::Frame;
use halfshade_strategy::StrategyError;

/// Everything that a frame has.
#[derive(Debug)]
pub struct FrameArrays<'a> {
    /// Light space is `rotation · (point - origin)`.
    pub rotation: DMat3,
    /// Its origin in the world.
    pub origin: DVec3,
    /// Spheres in light space.
    pub spheres: &'a [BlockingSphere],
    /// Lamps in light space.
    pub lamps: &'a [Lamp],
    /// Irradiance of everything but lamps.
    pub rest: &'a Irradiance,
    /// How often that has become another one.
    pub light_changes: u32,
}

impl BakedScene {
    /// Whether receivers see the spheres of their own object.
    pub fn sees_own(&self) -> bool {
        self.settings.own == Own::Spheres
    }

    /// Brings everything up to a frame, and gives it.
    pub fn frame_arrays(&mut self, frame: &Frame<'_>) -> Result<FrameArrays<'_>, StrategyError> {
        self.prepare_frame(frame)?;
        Ok(FrameArrays {
            rotation: self.frame.space.rotation,
            origin: self.frame.space.origin,
            spheres: &self.frame.spheres,
            lamps: &self.frame.lamps,
            rest: &self.light.rest,
            light_changes: self.light_changes,
        })
    }
}
