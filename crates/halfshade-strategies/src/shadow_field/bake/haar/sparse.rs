//! Haar vectors of which most coefficients are nothing.

use halfshade_sh::haar::cube::Cube;
use serde::{Deserialize, Serialize};

/// Numbers, ascending, and values of the coefficients that are not 0.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Sparse {
    pub(crate) indices: Vec<u16>,
    pub(crate) values: Vec<f32>,
}

impl Sparse {
    /// The `kept` largest of a dense vector.
    pub(crate) fn largest(dense: &[f32], kept: usize) -> Self {
        let mut indices: Vec<u16> = (0..dense.len() as u16).filter(|&i| dense[usize::from(i)] != 0.0).collect();
        if indices.len() > kept {
            let size = |i: &u16| dense[usize::from(*i)].abs();
            // The first of equal ones, so that the choice is always the same.
            indices.sort_by(|i, j| size(j).total_cmp(&size(i)));
            indices.truncate(kept);
            indices.sort_unstable();
        }
        let values = indices.iter().map(|&i| dense[usize::from(i)]).collect();
        Self { indices, values }
    }

    /// The faces that have any, as bits.
    pub(crate) fn faces(&self, cube: Cube) -> u8 {
        self.indices.iter().fold(0, |faces, &index| faces | 1 << (usize::from(index) / cube.face_len()))
    }

    /// Adds `weight` times the vector to a dense one.
    pub(crate) fn add_to(&self, dense: &mut [f32], weight: f32) {
        for (&index, value) in self.indices.iter().zip(&self.values) {
            dense[usize::from(index)] += weight * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_are_kept_in_order() {
        let sparse = Sparse::largest(&[0.0, 3.0, -5.0, 1.0, 3.0, 0.0], 3);
        assert_eq!(sparse, Sparse { indices: vec![1, 2, 4], values: vec![3.0, -5.0, 3.0] });
        assert_eq!(Sparse::largest(&[0.0, 1.0], 5).indices, [1]);
        assert_eq!(Sparse::largest(&[2.0, 1.0], 0), Sparse::default());
        let mut dense = [1.0; 6];
        sparse.add_to(&mut dense, 2.0);
        assert_eq!(dense, [1.0, 7.0, -9.0, 1.0, 7.0, 1.0]);
    }
}
