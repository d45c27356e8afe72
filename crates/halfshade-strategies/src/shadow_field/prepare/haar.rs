//! A frame on the texels of a cube.

use super::{
    cube_light::{CubeLight, cube_light},
    frame::FrameData,
    texel_map::TexelMap,
};
use crate::shadow_field::bake::haar::HaarFields;
use halfshade_scene::Frame;
use halfshade_strategy::StrategyError;
use rayon::prelude::*;

/// Everything that shading reads of a frame.
pub(crate) struct HaarFrame {
    pub(crate) data: FrameData,
    pub(crate) light: CubeLight,
    /// Per object from the texels of its cube to those of the light's.
    pub(crate) texel_maps: Vec<TexelMap>,
}

/// Fields of the scene and a frame of it: who has both can shade.
pub(crate) struct HaarPrepared<'a> {
    pub(crate) fields: &'a HaarFields,
    pub(crate) frame: &'a HaarFrame,
}

impl HaarFrame {
    /// A frame; the light of the last one is kept if it is the same.
    pub(crate) fn new(fields: &HaarFields, frame: &Frame<'_>, last: Option<Self>) -> Result<Self, StrategyError> {
        let data = FrameData::new(frame, &fields.objects)?;
        let environment = &frame.scene.environment;
        let light = match last {
            Some(last) if last.light.environment.is_same_as(environment) => last.light,
            _ => cube_light(&fields.basis, environment),
        };
        let texel_map =
            |object: &super::frame::ObjectPlacement| TexelMap::new(fields.basis.cube, object.object_from_light);
        let texel_maps = data.objects.par_iter().map(texel_map).collect();
        Ok(Self { data, light, texel_maps })
    }
}
