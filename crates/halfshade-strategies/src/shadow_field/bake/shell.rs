//! A shell as it is kept for shading.

use super::{
    basis::{Basis, Storage},
    grid::Grid,
};

/// The vectors of a shell.
pub(crate) type VectorOf<S> = <<S as Shell>::Basis as Basis>::Vector;

/// Sample points around an object at one distance, stored.
pub(crate) trait Shell: Sized + Send + Sync {
    type Basis: Basis;
    /// Accumulator of vectors.
    type Sum;

    fn store(basis: &Self::Basis, grid: &Grid<VectorOf<Self>>, storage: Storage) -> Self;

    /// Sample points along longitude, as along latitude.
    fn resolution(&self) -> usize;

    /// Bytes that it takes.
    fn bytes(&self) -> usize;

    /// Adds `share` of the weighted sum of four samples; weights are of sum 1.
    fn add(&self, samples: [(usize, f32); 4], share: f32, sum: &mut Self::Sum);
}
