//! A frame in spherical harmonics.

use super::{
    frame::FrameData,
    sh_light::{DistantLight, distant_light},
};
use crate::shadow_field::bake::sh::ShFields;
use halfshade_scene::Frame;
use halfshade_sh::rotation::ShRotation;
use halfshade_strategy::StrategyError;

/// Everything that shading reads of a frame.
pub(crate) struct ShFrame {
    pub(crate) data: FrameData,
    /// S_d.
    pub(crate) light: DistantLight,
    /// Per object the blocks of the SH rotation from object space into light space, band by band, row by row.
    pub(crate) rotations: Vec<Vec<f32>>,
}

/// Fields of the scene and a frame of it: who has both can shade.
pub(crate) struct ShPrepared<'a> {
    pub(crate) fields: &'a ShFields,
    pub(crate) frame: &'a ShFrame,
}

impl ShFrame {
    /// A frame; the light of the last one is kept if it is the same.
    pub(crate) fn new(fields: &ShFields, frame: &Frame<'_>, last: Option<Self>) -> Result<Self, StrategyError> {
        let data = FrameData::new(frame, &fields.objects)?;
        let environment = &frame.scene.environment;
        let light = match last {
            Some(last) if last.light.environment.is_same_as(environment) => last.light,
            _ => distant_light(fields.bands, environment),
        };
        let rotations =
            data.objects.iter().map(|object| light_from_object(fields.bands, object.object_from_light)).collect();
        Ok(Self { data, light, rotations })
    }
}

/// The rotation `object_from_light`, inverted, as blocks row by row.
fn light_from_object(bands: usize, object_from_light: [[f32; 3]; 3]) -> Vec<f32> {
    let rotation = ShRotation::new(bands, &object_from_light.map(|row| row.map(f64::from)));
    // The inverse is the transpose, of which columns are rows.
    (0..bands).flat_map(|l| rotation.block(l).iter().map(|&value| value as f32).collect::<Vec<_>>()).collect()
}
