//! An irradiance volume [Greger1998] with transfer: what light from infinitely far becomes at points of a grid in a scene that stands
//! still, for receivers that move through it.
//!
//! ```text
//! M_ij(p) = ∫ y_i(ω) (V(p, ω) y_j(ω) + (1 - V(p, ω)) albedo(h) T_j(h)) dω
//! ```
//!
//! with h what is met along ω and T its transfer with one bounce less than the scene asks for: M times the light's vector is the
//! vector of the light that arrives at p. The integral is a sum over directions in equal shares of the sphere, as the identity
//! less what is hidden, so that a point that sees everything is exact.
//!
//! A body that keeps its shape has transfer of its own, in its own space (`own`): what it hides from itself is baked, and turns with it.
//! Bodies that deform, and all where transfer is unshadowed, have the cosine about their normals.
//!
//! **Where it errs.** Bodies that move hide nothing from each other or from what stands still, and reflect nothing. Between points all is linear, so that light leaks through walls that are thinner than a step. Points within solids know
//! no light: they take the mean of their neighbours outside, step by step inwards.

mod bounds;
mod own;
mod probes;

use super::table::{PADDING, Transfer};
use crate::prt::kernel::{grid::Grid, volume::COEFFICIENTS};
pub(crate) use bounds::of_movers;
pub(crate) use own::of_bodies;
pub(crate) use probes::Probes;
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
        let point = probes::identity(bands);
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
