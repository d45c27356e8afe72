//! The table of transfer vectors.

use super::{gloss_table::GlossTable, rows::ObjectRows};
use halfshade_scene::Mesh;
use std::sync::Arc;

/// Numbers past the end of a table, so that eight at a time can be read from anywhere.
pub(crate) const PADDING: usize = 7;

/// Transfer vectors of a scene, in the world as it is at the first frame.
#[derive(Debug)]
pub(crate) struct Transfer {
    pub(crate) bands: usize,
    /// Vectors per row: 1, or 3 for red, green and blue where light that coloured surfaces reflect differs.
    pub(crate) channels: usize,
    pub(crate) bounces: usize,
    pub(crate) objects: Vec<(Arc<Mesh>, ObjectRows)>,
    /// Vectors of bands² numbers, and 7 zeros at the end.
    pub(crate) values: Vec<f32>,
    /// Matrices of glossy objects, as many per row as there are vectors; nothing where none is glossy.
    pub(crate) gloss: Option<GlossTable>,
}

impl Transfer {
    /// Numbers of a row.
    pub(crate) fn width(&self) -> usize {
        self.channels * self.bands * self.bands
    }

    /// All rows, without the padding.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.values[..self.values.len() - PADDING]
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }
}
