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

    /// Gives every row of one vector as many equal ones as there are channels, if it has them not yet.
    pub(crate) fn repeat_channels(&mut self, channels: usize) {
        if self.channels != channels {
            let vectors = self.values.chunks_exact(self.bands * self.bands);
            self.values = vectors.flat_map(|vector| vector.repeat(channels)).collect();
            self.channels = channels;
        }
    }

    /// Adds a share of the vector of a row for a channel, compressed or not.
    pub(crate) fn add_vector(&self, row: usize, channel: usize, share: f32, sum: &mut [f32]) {
        let mut add = |vector: &[f32], share: f32| {
            sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum = share.mul_add(*value, *sum));
        };
        let Some(clusters) = &self.clusters else { return add(self.vector(row, channel), share) };
        let (width, count) = (self.width(), self.bands * self.bands);
        let first = usize::from(clusters.of_row[row]) * (clusters.components + 1);
        let part = |number: usize| {
            let channel = if self.channels == 1 { 0 } else { channel };
            &clusters.vectors[(first + number) * width + channel * count..][..count]
        };
        add(part(0), share);
        let weights = &clusters.weights[row * clusters.components..][..clusters.components];
        (1..).zip(weights).for_each(|(number, weight)| add(part(number), share * weight));
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
