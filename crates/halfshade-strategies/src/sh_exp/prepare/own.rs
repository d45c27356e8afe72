//! Own occlusion of a frame: how objects are turned, and which spheres are theirs.

use super::emitters::IntoLight;
use crate::{
    sh_exp::kernel::OwnSpheres,
    shared::{light_space::LightSpace, rotate::blocks},
};
use halfshade_scene::Frame;

/// Objects as they are turned in a frame; empty if their spheres hide them from themselves.
#[derive(Debug, Clone, Default)]
pub(crate) struct OwnView {
    /// Per object the blocks of the SH rotation from object space into light space.
    pub(crate) rotations: Vec<Vec<f32>>,
    /// Per object the rows of the rotation from light space into its own.
    pub(crate) object_from_light: Vec<[[f32; 3]; 3]>,
    /// Per object its spheres.
    pub(crate) spheres: Vec<OwnSpheres>,
}

impl OwnView {
    pub(crate) fn new(bands: usize, frame: &Frame<'_>, space: &LightSpace, spheres: Vec<OwnSpheres>) -> Self {
        let rotations = IntoLight::new(bands, frame).of_objects().iter().map(blocks).collect();
        let object_from_light = frame.world_from_object.iter().map(|pose| space.rows_into_object(pose)).collect();
        Self { rotations, object_from_light, spheres }
    }
}
