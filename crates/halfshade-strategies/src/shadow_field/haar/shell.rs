//! A shell of Haar vectors in memory.

use super::{
    super::{
        basis::{Shell, Storage},
        shells::{Grid, four_nearest},
    },
    projection::HaarBasis,
    rows::Rows,
    sparse::Sparse,
    sum::Sum,
};
use serde::{Deserialize, Serialize};

/// One shell.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct HaarShell {
    resolution: usize,
    rows: Rows,
}

impl Shell for HaarShell {
    type Basis = HaarBasis;
    type Sum = Sum;

    fn store(basis: &HaarBasis, grid: &Grid<Sparse>, storage: Storage) -> Self {
        Self { resolution: grid.resolution, rows: Rows::store(basis.cube, &grid.samples, storage, basis.coding) }
    }

    fn resolution(&self) -> usize {
        self.resolution
    }

    fn bytes(&self) -> usize {
        self.rows.bytes()
    }

    fn add(&self, u: f32, v: f32, share: f32, sum: &mut Sum) {
        let (places, weights) = four_nearest(self.resolution, u, v);
        for (place, weight) in places.into_iter().zip(weights) {
            self.rows.add(place, share * weight, sum);
        }
    }
}
