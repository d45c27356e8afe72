//! Own occlusion of a frame: how objects are turned, and which spheres are theirs.

use super::emitters::IntoLight;
use crate::{sh_exp::kernel::OwnSpheres, shared::rotate::blocks};
use glam::DQuat;
use halfshade_scene::Frame;

/// Objects as they are turned in a frame; empty if their spheres hide them from themselves.
#[derive(Debug, Clone, Default)]
pub(crate) struct OwnView {
    /// Per object the blocks of the SH rotation from object space into light space.
    pub(crate) rotations: Vec<Vec<f32>>,
    /// Per object the rows of the rotation from light space into its own.
    pub(crate) object_from_light: Vec<[f32; 9]>,
    /// Per object its spheres.
    pub(crate) spheres: Vec<OwnSpheres>,
}

impl OwnView {
    pub(crate) fn new(bands: usize, frame: &Frame<'_>, spheres: Vec<OwnSpheres>) -> Self {
        let into_light = IntoLight::new(bands, frame);
        let rotations = into_light.of_objects().iter().map(blocks).collect();
        // Columns of a rotation are rows of its inverse.
        let inverse = |object| into_light.directions(object, DQuat::IDENTITY).to_cols_array().map(|value| value as f32);
        let object_from_light = (0..frame.world_from_object.len()).map(inverse).collect();
        Self { rotations, object_from_light, spheres }
    }
}
