//! The three phases in Haar wavelets.

use super::{
    bake::{
        details::{details, footprint},
        field::Field,
        haar::{HaarFields, rows::Rows, shell::HaarShell, sparse::Sparse, sum::Sum},
    },
    prepare::haar::{HaarFrame, HaarPrepared},
};
use halfshade_scene::Frame;
use halfshade_strategy::{Baked, Detail, Footprint, Prepared, StrategyError};

/// Fields of a scene, and the last frame that was prepared.
pub(super) struct HaarBaked {
    fields: HaarFields,
    frame: Option<HaarFrame>,
}

impl HaarBaked {
    pub(super) const fn new(fields: HaarFields) -> Self {
        Self { fields, frame: None }
    }
}

impl Baked for HaarBaked {
    fn footprint(&self) -> Footprint {
        footprint(&self.fields.objects, Rows::bytes)
    }

    fn details(&self) -> Vec<Detail> {
        let cube = self.fields.basis.cube;
        let read = |field: &Field<HaarShell>, place| {
            let mut sum = Sum::new(cube);
            field.add_at(place, std::slice::from_mut(&mut sum));
            // All of it, as shading has it.
            Sparse::largest(&sum.values, cube.len())
        };
        details(&self.fields.basis, &self.fields.objects, read)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let frame = HaarFrame::new(&self.fields, frame, self.frame.take())?;
        Ok(Box::new(HaarPrepared { fields: &self.fields, frame: self.frame.insert(frame) }))
    }
}
