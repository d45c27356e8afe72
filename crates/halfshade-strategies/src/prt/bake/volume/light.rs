//! Vectors of light that arrives at points of a grid.

use crate::prt::{
    bake::table::Transfer,
    kernel::{dot::PADDING, grid::Grid, volume::COEFFICIENTS},
};
use std::sync::Arc;

/// Light that arrives at points of a grid, by the light from infinitely far.
#[derive(Debug)]
pub(crate) struct Volume {
    /// In the world as it is at the first frame.
    pub(crate) grid: Grid,
    /// Vectors of a row: 1, or 3 for red, green and blue.
    pub(crate) channels: usize,
    /// Rows of as many vectors, one for each coefficient of the light that arrives, point after point; and zeros at the end.
    pub(crate) vectors: Vec<f32>,
    /// Points within solids.
    pub(crate) inside: usize,
    /// Transfer of bodies in their own space, by object; those that have none take the cosine.
    pub(crate) own: Vec<Option<Arc<Transfer>>>,
}

impl Volume {
    /// The volume where nothing hides any light.
    pub(crate) fn open(grid: Grid, bands: usize) -> Self {
        let point = identity(bands);
        let points = std::iter::repeat_n(point, grid.len()).flatten();
        Self { grid, channels: 1, vectors: points.chain([0.0; PADDING]).collect(), inside: 0, own: Vec::new() }
    }

    /// Bytes of all vectors.
    pub(crate) fn bytes(&self) -> usize {
        let is_first = |number: usize, own: &Arc<Transfer>| {
            !self.own[..number].iter().flatten().any(|other| Arc::ptr_eq(other, own))
        };
        let own = self.own.iter().enumerate().filter_map(|(number, own)| {
            own.as_ref().filter(|own| is_first(number, own)).map(|own| size_of_val(own.values.as_slice()))
        });
        size_of_val(self.vectors.as_slice()) + own.sum::<usize>()
    }

    /// Rows of all points.
    pub(crate) fn rows(&self) -> usize {
        COEFFICIENTS * self.grid.len()
    }
}

/// Rows of a point that sees everything: the light itself.
pub(super) fn identity(bands: usize) -> Vec<f32> {
    let count = bands * bands;
    let row = |i: usize| (0..count).map(move |j| if i == j { 1.0 } else { 0.0 });
    (0..COEFFICIENTS).flat_map(row).collect()
}
