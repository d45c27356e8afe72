//! Frame data: everything that shading reads of a frame.

use crate::shared::{
    blockers::{Blockers, BlockingSphere, blocking_spheres},
    divided_light::DividedLight,
    light_space::LightSpace,
    placed_lamps::{Lamp, placed_lamps},
};
use glam::DVec3;
use halfshade_scene::Frame;

/// Spheres and lamps of a frame.
#[derive(Debug, Default)]
pub(crate) struct FrameData {
    pub(crate) space: LightSpace,
    pub(crate) spheres: Vec<BlockingSphere>,
    pub(crate) lamps: Vec<Lamp>,
}

impl FrameData {
    /// A frame of a scene with these blockers.
    pub(crate) fn new(frame: &Frame<'_>, blockers: &Blockers, light: &DividedLight) -> Self {
        let by_object: Vec<Vec<(DVec3, f32)>> = blockers.placed_by_object(frame).collect();
        let space = LightSpace::new(frame, by_object.iter().flatten().map(|(center, _)| *center));
        Self {
            spheres: blocking_spheres(&by_object, &space),
            lamps: placed_lamps(frame, light.suns(&frame.scene.environment), |point| space.point(point)),
            space,
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.spheres.as_slice()) + size_of_val(self.lamps.as_slice())
    }
}
