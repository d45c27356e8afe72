//! The accumulator of Haar vectors.

use super::sparse::Sparse;
use halfshade_sh::haar::cube::Cube;

/// A sum of vectors, dense.
#[derive(Debug)]
pub(crate) struct Sum {
    pub(crate) cube: Cube,
    pub(crate) values: Vec<f32>,
    /// Faces on which something was added, as bits.
    pub(crate) faces: u8,
}

impl Sum {
    pub(crate) fn new(cube: Cube) -> Self {
        Self { cube, values: vec![0.0; cube.len()], faces: 0 }
    }

    /// Adds a vector.
    pub(crate) fn add(&mut self, vector: &Sparse) {
        vector.add_to(&mut self.values, 1.0);
        self.faces |= vector.faces(self.cube);
    }

    /// Back to 0.
    pub(crate) fn clear(&mut self) {
        for (face, values) in self.values.chunks_exact_mut(self.cube.face_len()).enumerate() {
            if self.faces & (1 << face) != 0 {
                values.fill(0.0);
            }
        }
        self.faces = 0;
    }
}
