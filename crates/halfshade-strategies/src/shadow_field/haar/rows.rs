//! Sparse Haar vectors in memory, one after another.

use super::{super::basis::Storage, sparse::Sparse};
use halfshade_sh::haar::cube::Cube;
use serde::{Deserialize, Serialize};

/// A sum of vectors.
#[derive(Debug)]
pub(super) struct Sum {
    pub(super) cube: Cube,
    pub(super) values: Vec<f32>,
    /// Faces on which something was added: bits.
    pub(super) faces: u8,
}

impl Sum {
    pub(super) fn new(cube: Cube) -> Self {
        Self { cube, values: vec![0.0; cube.len()], faces: 0 }
    }

    /// Adds a vector.
    pub(super) fn add(&mut self, vector: &Sparse) {
        vector.add_to(&mut self.values, 1.0);
        let face = |index: &u16| usize::from(*index) / self.cube.face_len();
        self.faces |= vector.indices.iter().fold(0, |faces, index| faces | 1 << face(index));
    }

    pub(super) fn clear(&mut self) {
        for (face, values) in self.values.chunks_exact_mut(self.cube.face_len()).enumerate() {
            if self.faces & (1 << face) != 0 {
                values.fill(0.0);
            }
        }
        self.faces = 0;
    }
}

/// Vectors: number and value of every coefficient.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Rows {
    /// Coefficients of a face.
    face_len: usize,
    /// Where each row starts, and the end.
    starts: Vec<u32>,
    indices: Vec<u16>,
    values: Values,
    /// Per level of wavelets the smallest value and the step: those of a level are alike in size. 0 and 1 unless in 8
    /// bits.
    least: Vec<f32>,
    step: Vec<f32>,
}

#[derive(Debug, Serialize, Deserialize)]
enum Values {
    U8(Vec<u8>),
    /// As bits.
    F16(Vec<u16>),
    F32(Vec<f32>),
}

/// Level of a coefficient, 0 for the scaling function, by its number on its face.
fn level(face_len: usize, index: u16) -> usize {
    let on_face = usize::from(index) & (face_len - 1);
    on_face.checked_ilog2().map_or(0, |log| log as usize / 2 + 1)
}

impl Rows {
    pub(super) fn store(cube: Cube, vectors: &[Sparse], storage: Storage) -> Self {
        let mut starts = vec![0];
        for vector in vectors {
            starts.push(starts[starts.len() - 1] + vector.indices.len() as u32);
        }
        let indices: Vec<u16> = vectors.iter().flat_map(|vector| &vector.indices).copied().collect();
        let all: Vec<f32> = vectors.iter().flat_map(|vector| &vector.values).copied().collect();
        let levels = cube.side().ilog2() as usize + 1;
        let (mut least, mut step) = (vec![0.0; levels], vec![1.0; levels]);
        let values = match storage {
            Storage::U8 => {
                let (mut low, mut high) = (vec![f32::INFINITY; levels], vec![f32::NEG_INFINITY; levels]);
                for (&index, &value) in indices.iter().zip(&all) {
                    let level = level(cube.face_len(), index);
                    (low[level], high[level]) = (low[level].min(value), high[level].max(value));
                }
                for level in 0..levels {
                    if low[level] <= high[level] {
                        (least[level], step[level]) = (low[level], (high[level] - low[level]) / 255.0);
                    }
                }
                let quantized = |(&index, &value): (&u16, &f32)| {
                    let level = level(cube.face_len(), index);
                    if step[level] > 0.0 { ((value - least[level]) / step[level]).round() as u8 } else { 0 }
                };
                Values::U8(indices.iter().zip(&all).map(quantized).collect())
            }
            Storage::F16 => Values::F16(all.iter().map(|&value| half::f16::from_f32(value).to_bits()).collect()),
            Storage::F32 => Values::F32(all),
        };
        Self { face_len: cube.face_len(), starts, indices, values, least, step }
    }

    pub(super) fn bytes(&self) -> usize {
        let values = match &self.values {
            Values::U8(values) => values.len() + 8 * self.least.len(),
            Values::F16(values) => 2 * values.len(),
            Values::F32(values) => 4 * values.len(),
        };
        4 * self.starts.len() + 2 * self.indices.len() + values
    }

    /// Adds `weight` times a row.
    #[inline]
    pub(super) fn add(&self, row: usize, weight: f32, sum: &mut Sum) {
        if weight == 0.0 {
            return;
        }
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        let indices = &self.indices[range.clone()];
        match &self.values {
            Values::U8(values) => {
                for (&index, &value) in indices.iter().zip(&values[range]) {
                    let level = level(self.face_len, index);
                    let value = f32::from(value).mul_add(self.step[level], self.least[level]);
                    sum.values[usize::from(index)] += weight * value;
                }
            }
            Values::F16(values) => {
                for (&index, &value) in indices.iter().zip(&values[range]) {
                    sum.values[usize::from(index)] += weight * half::f16::from_bits(value).to_f32();
                }
            }
            Values::F32(values) => {
                for (&index, value) in indices.iter().zip(&values[range]) {
                    sum.values[usize::from(index)] += weight * value;
                }
            }
        }
        let face_bits = self.face_len.ilog2();
        sum.faces |= indices.iter().fold(0, |faces, index| faces | 1 << (u32::from(*index) >> face_bits));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_their_values_to_the_step() {
        let cube = Cube::new(2);
        let vectors = [
            Sparse { indices: vec![0, 1, 5, 40, 95], values: vec![0.7, -0.2, 0.11, 0.03, -0.07] },
            Sparse::default(),
            Sparse { indices: vec![0, 17], values: vec![0.1, 0.4] },
        ];
        for (storage, bound) in [(Storage::F32, 0.0), (Storage::F16, 5e-4), (Storage::U8, 0.6 / 255.0)] {
            let rows = Rows::store(cube, &vectors, storage);
            for (number, vector) in vectors.iter().enumerate() {
                let mut sum = Sum::new(cube);
                rows.add(number, 0.5, &mut sum);
                let mut expected = vec![0.0; cube.len()];
                vector.add_to(&mut expected, 0.5);
                assert!(sum.values.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= bound), "{storage:?} {number}");
                let touched = (0..6).filter(|face| sum.faces & (1 << face) != 0).count();
                assert_eq!(touched, [3, 0, 2][number]);
                sum.clear();
                assert!(sum.values.iter().all(|value| *value == 0.0) && sum.faces == 0);
            }
        }
    }
}
