//! The buffers of shadow fields, for callers of single functions.

use super::{
    frame::{FrameUniforms, frame_rows},
    tables::Tables,
};
use crate::{receivers::KernelSpace, rows::Row};
use glam::{DMat3, DVec3};
use halfshade_scene::{Scene, VertexWeights};
use halfshade_strategies::shadow_field::arrays::{FrameArrays, SceneArrays};

/// Buffers that the functions of `shadow_field` read of a frame, in the units of the scene.
#[derive(Debug)]
pub struct FieldBuffers {
    /// Settings.
    pub uniforms: FrameUniforms,
    /// Objects and lights.
    pub rows: Vec<Row>,
    /// Samples of all fields.
    pub samples: Vec<Row>,
    tables: Tables,
}

impl FieldBuffers {
    /// Fields of a scene, a frame, and receivers, each with its object and the vertices around it.
    pub fn new(
        scene: &Scene,
        fields: &SceneArrays<'_>,
        frame: &FrameArrays<'_>,
        receivers: impl IntoIterator<Item = (usize, Option<VertexWeights>)>,
    ) -> Self {
        let (mut tables, samples) = Tables::new(fields, scene);
        tables.place_receivers(receivers.into_iter());
        let space = KernelSpace { rotation: DMat3::IDENTITY, center: DVec3::ZERO, scale: 1.0 };
        let (rows, uniforms) = frame_rows(frame, &tables, &space, scene.camera.eye);
        Self { uniforms, rows, samples, tables }
    }

    /// Tables that stay from frame to frame.
    pub fn tables(&self) -> &[Row] {
        &self.tables.rows
    }

    /// The row of the tables at which the field of an object begins.
    pub fn field(&self, object: usize) -> u32 {
        self.tables.objects[object].field
    }
}
