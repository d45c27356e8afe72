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
//! **Where it errs.** Receivers that move hide nothing from each other, from themselves or from what stands still, and reflect
//! nothing. Between points all is linear, so that light leaks through walls that are thinner than a step. Points within solids know
//! no light: they take the mean of their neighbours outside, step by step inwards.

mod bounds;
mod probes;

use super::table::PADDING;
use crate::prt::kernel::{grid::Grid, volume::COEFFICIENTS};
pub(crate) use bounds::of_movers;
pub(crate) use probes::Probes;

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
}

impl Volume {
    /// The volume where nothing hides any light.
    pub(crate) fn open(grid: Grid, bands: usize) -> Self {
        let point = probes::identity(bands);
        let points = std::iter::repeat_n(point, grid.len()).flatten();
        Self { grid, channels: 1, vectors: points.chain([0.0; PADDING]).collect(), inside: 0 }
    }

    /// Rows of all points.
    pub(crate) fn rows(&self) -> usize {
        COEFFICIENTS * self.grid.len()
    }
}
