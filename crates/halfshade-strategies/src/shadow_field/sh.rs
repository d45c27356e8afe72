//! The three phases in spherical harmonics.

use super::{
    bake::{
        details::{details, footprint},
        sh::ShFields,
    },
    kernel::reconstruct::MOST,
    prepare::sh::{ShFrame, ShPrepared},
};
use halfshade_scene::Frame;
use halfshade_strategy::{Baked, Detail, Footprint, Prepared, StrategyError};

/// Fields of a scene, and the last frame that was prepared.
pub struct ShBaked {
    pub(super) fields: ShFields,
    pub(super) frame: Option<ShFrame>,
}

impl ShBaked {
    pub(super) const fn new(fields: ShFields) -> Self {
        Self { fields, frame: None }
    }
}

impl std::fmt::Debug for ShBaked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ShBaked").field("bands", &self.fields.bands).finish_non_exhaustive()
    }
}

impl Baked for ShBaked {
    fn footprint(&self) -> Footprint {
        footprint(&self.fields.objects, |own| size_of_val(own.as_slice()))
    }

    fn details(&self) -> Vec<Detail> {
        let count = self.fields.bands * self.fields.bands;
        details(&self.fields.basis, &self.fields.objects, |field, place| {
            let mut sum = [0.0; MOST];
            field.add_at(place, std::slice::from_mut(&mut sum));
            sum[..count].to_vec()
        })
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let frame = ShFrame::new(&self.fields, frame, self.frame.take())?;
        Ok(Box::new(ShPrepared { fields: &self.fields, frame: self.frame.insert(frame) }))
    }
}
