//! A shell of Haar vectors in memory.

use super::{projection::HaarBasis, rows::Rows, sparse::Sparse, sum::Sum};
use crate::shadow_field::{
    bake::{basis::Storage, grid::Grid, shell::Shell},
    settings::Coding,
};
use halfshade_sh::haar::cube::Cube;
use serde::{Deserialize, Serialize};

/// One shell.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct HaarShell {
    resolution: usize,
    rows: Rows,
}

impl HaarShell {
    /// Whether it has a row for each of its points, and all rows can be read.
    pub(crate) fn fits(&self, cube: Cube, stored_as: (Coding, Storage)) -> bool {
        let count = self.resolution.checked_mul(self.resolution);
        self.resolution.is_power_of_two() && count.is_some_and(|count| self.rows.fit(cube, count, stored_as))
    }
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

    fn add(&self, samples: [(usize, f32); 4], share: f32, sum: &mut Sum) {
        samples.into_iter().for_each(|(sample, weight)| self.rows.add(sample, share * weight, sum));
    }
}
