//! The table of transfer vectors.

use super::{compress::Clusters, gloss_table::GlossTable, rows::ObjectRows};
use crate::prt::kernel::dot::PADDING;
use halfshade_scene::Mesh;
use std::sync::Arc;

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
    /// Stored instead of those, which are none then, where they are compressed.
    pub(crate) clusters: Option<Clusters>,
    /// Matrices of glossy objects, as many per row as there are vectors; nothing where none is glossy.
    pub(crate) gloss: Option<GlossTable>,
}

impl Transfer {
    /// Numbers of a row.
    pub(crate) fn width(&self) -> usize {
        self.channels * self.bands * self.bands
    }

    /// The vector of a row for a channel, before anything is compressed.
    pub(crate) fn vector(&self, row: usize, channel: usize) -> &[f32] {
        let count = self.bands * self.bands;
        let channel = if self.channels == 1 { 0 } else { channel };
        &self.values[row * self.width() + channel * count..][..count]
    }

    /// All rows, without the padding.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.values[..self.values.len() - PADDING]
    }

    /// Number of rows, compressed or not.
    pub(crate) fn row_count(&self) -> usize {
        self.clusters.as_ref().map_or(self.rows().len() / self.width(), |clusters| clusters.of_row.len())
    }

    /// Bytes by part.
    pub(crate) fn parts(&self) -> Vec<(&'static str, usize)> {
        let bytes = |values: &[f32]| size_of_val(values);
        match &self.clusters {
            None => vec![("transfer vectors", bytes(&self.values))],
            Some(Clusters { of_row, weights, vectors, .. }) => vec![
                ("means and axes of clusters", bytes(vectors)),
                ("weights", bytes(weights)),
                ("clusters of rows", size_of_val(of_row.as_slice())),
            ],
        }
    }
}
