//! Sparse Haar vectors in memory, one after another, as bytes in either [`Coding`] (`kernel/wavelet_rows.rs` reads them).

use super::{sparse::Sparse, sum::Sum};
use crate::shadow_field::{
    bake::basis::Storage,
    kernel::wavelet_rows::{MEAN, RowReader, Square, level},
    settings::Coding,
};
use halfshade_sh::haar::cube::Cube;
use serde::{Deserialize, Serialize};

/// Vectors: place and value of every coefficient.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Rows {
    /// Coefficients of a face.
    face_len: usize,
    coding: Coding,
    storage: Storage,
    /// Where each row starts, and the end.
    starts: Vec<u32>,
    bytes: Vec<u8>,
    /// Per level of wavelets, after the mean, the smallest value and the step: those of a level are alike in size. 0 and 1
    /// unless in 8 bits.
    scale: Vec<[f32; 2]>,
}

impl Rows {
    /// Vectors of a cube, stored.
    pub(crate) fn store(cube: Cube, vectors: &[Sparse], storage: Storage, coding: Coding) -> Self {
        let (face_len, levels) = (cube.face_len(), cube.side().ilog2() as usize + 1);
        let mut scale = vec![[0.0, 1.0]; levels];
        if storage == Storage::U8 {
            let mut range = vec![[f32::INFINITY, f32::NEG_INFINITY]; levels];
            for (&index, &value) in vectors.iter().flat_map(|vector| vector.indices.iter().zip(&vector.values)) {
                let [low, high] = &mut range[level(face_len, index)];
                (*low, *high) = (low.min(value), high.max(value));
            }
            for (scale, [low, high]) in scale.iter_mut().zip(range) {
                if low <= high {
                    *scale = [low, (high - low) / 255.0];
                }
            }
        }
        let mut rows = Self { face_len, coding, storage, starts: vec![0], bytes: Vec::new(), scale };
        let mut dense = vec![None; cube.len()];
        for vector in vectors {
            rows.bytes.push(vector.faces(cube));
            match coding {
                Coding::Listed => {
                    for (&index, &value) in vector.indices.iter().zip(&vector.values) {
                        rows.bytes.extend(index.to_le_bytes());
                        rows.push(level(face_len, index), value);
                    }
                }
                Coding::Tree => {
                    dense.fill(None);
                    vector
                        .indices
                        .iter()
                        .zip(&vector.values)
                        .for_each(|(&i, &value)| dense[usize::from(i)] = Some(value));
                    for face in dense.chunks_exact(face_len) {
                        rows.push_square(face, Square::WHOLE);
                    }
                }
            }
            rows.starts.push(rows.bytes.len() as u32);
        }
        rows
    }

    /// Whether there are `count` rows of vectors on `cube`, stored so, and each can be read to its end.
    pub(crate) fn fit(&self, cube: Cube, count: usize, stored_as: (Coding, Storage)) -> bool {
        let levels = cube.side().ilog2() as usize + 1;
        let ends = self.starts.windows(2).map(|pair| [pair[0] as usize, pair[1] as usize]);
        (self.face_len, self.scale.len()) == (cube.face_len(), levels)
            && (self.coding, self.storage) == stored_as
            && self.scale.iter().flatten().all(|value| value.is_finite())
            && self.starts.first() == Some(&0)
            && self.starts.len().checked_sub(1) == Some(count)
            && ends.into_iter().all(|[start, end]| self.bytes.get(start..end).is_some_and(|row| self.is_row(cube, row)))
    }

    /// Whether a row has faces and coefficients that `cube` has, and ends with the last of them.
    fn is_row(&self, cube: Cube, row: &[u8]) -> bool {
        let Some((&faces, mut rest)) = row.split_first() else { return false };
        let value_bytes = match self.storage {
            Storage::U8 => 1,
            Storage::F16 => 2,
            Storage::F32 => 4,
        };
        match self.coding {
            Coding::Listed => {
                let index = |entry: &[u8]| usize::from(u16::from_le_bytes([entry[0], entry[1]]));
                let entries = rest.chunks_exact(2 + value_bytes);
                faces >> 6 == 0 && entries.remainder().is_empty() && entries.map(index).all(|index| index < cube.len())
            }
            Coding::Tree => {
                let count = faces.count_ones();
                faces >> 6 == 0
                    && (0..count).all(|_| self.skip_square(Square::WHOLE, value_bytes, &mut rest).is_some())
                    && rest.is_empty()
            }
        }
    }

    /// Leaves out what `rest` has of a square; nothing if the face has no such square, or bytes are missing.
    fn skip_square(&self, square: Square, value_bytes: usize, rest: &mut &[u8]) -> Option<()> {
        let present = *rest.split_off_first()?;
        let is_whole = square.level == 0;
        let may_have =
            [(MEAN, is_whole), (0b111, square.count < self.face_len), (0b111_1000, 4 * square.count < self.face_len)];
        if may_have.into_iter().any(|(bits, may)| present & bits != 0 && !may) {
            return None;
        }
        let values = (present & (MEAN | 0b111)).count_ones() as usize;
        rest.split_off(..values * value_bytes)?;
        let present = u32::from(present);
        square
            .quarters()
            .enumerate()
            .filter(|(bit, _)| present & (1 << (3 + bit)) != 0)
            .try_for_each(|(_, quarter)| self.skip_square(quarter, value_bytes, rest))
    }

    fn push(&mut self, level: usize, value: f32) {
        let [least, step] = self.scale[level];
        match self.storage {
            Storage::U8 => self.bytes.push(if step > 0.0 { ((value - least) / step).round() as u8 } else { 0 }),
            Storage::F16 => self.bytes.extend(half::f16::from_f32(value).to_le_bytes()),
            Storage::F32 => self.bytes.extend(value.to_le_bytes()),
        }
    }

    /// A square and all within it, if there is anything; whether there was.
    fn push_square(&mut self, face: &[Option<f32>], square: Square) -> bool {
        let first = self.bytes.len();
        let mut present = 0;
        self.bytes.push(0);
        if let (Some(mean), 0) = (face[0], square.level) {
            present |= MEAN;
            self.push(0, mean);
        }
        // A face of one texel has no wavelets.
        if square.count < face.len() {
            for (bit, index) in square.wavelets().enumerate() {
                if let Some(value) = face[index] {
                    present |= 1 << bit;
                    self.push(square.level + 1, value);
                }
            }
            if 4 * square.count < face.len() {
                for (bit, quarter) in square.quarters().enumerate() {
                    if self.push_square(face, quarter) {
                        present |= 1 << (3 + bit);
                    }
                }
            }
        }
        if present == 0 {
            self.bytes.truncate(first);
        } else {
            self.bytes[first] = present;
        }
        present != 0
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        let scale = if self.storage == Storage::U8 { size_of_val(self.scale.as_slice()) } else { 0 };
        4 * self.starts.len() + self.bytes.len() + scale
    }

    /// Adds `weight` times a row.
    #[inline]
    pub(crate) fn add(&self, row: usize, weight: f32, sum: &mut Sum) {
        let bytes = &self.bytes[self.starts[row] as usize..self.starts[row + 1] as usize];
        if weight == 0.0 {
            return;
        }
        match self.storage {
            Storage::U8 => self.add_bytes(bytes, weight, |[byte]: [u8; 1]| f32::from(byte), sum),
            Storage::F16 => self.add_bytes(bytes, weight, |bytes| half::f16::from_le_bytes(bytes).to_f32(), sum),
            Storage::F32 => self.add_bytes(bytes, weight, f32::from_le_bytes, sum),
        }
    }

    #[inline(always)]
    fn add_bytes<const BYTES: usize>(
        &self,
        bytes: &[u8],
        weight: f32,
        number: impl Fn([u8; BYTES]) -> f32,
        sum: &mut Sum,
    ) {
        let reader = RowReader { bytes, face_len: self.face_len, scale: &self.scale, weight, number };
        sum.faces |= match self.coding {
            Coding::Listed => reader.add_listed(&mut sum.values),
            Coding::Tree => reader.add_tree(&mut sum.values),
        };
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
            Sparse { indices: (0..96).collect(), values: (0..96).map(|i| 0.01 * i as f32).collect() },
        ];
        for coding in [Coding::Listed, Coding::Tree] {
            for (storage, bound) in [(Storage::F32, 0.0), (Storage::F16, 5e-4), (Storage::U8, 0.6 / 255.0)] {
                let rows = Rows::store(cube, &vectors, storage, coding);
                for (number, vector) in vectors.iter().enumerate() {
                    let mut sum = Sum::new(cube);
                    rows.add(number, 0.5, &mut sum);
                    let mut expected = vec![0.0; cube.len()];
                    vector.add_to(&mut expected, 0.5);
                    let is_near = |(a, b): (&f32, &f32)| (a - b).abs() <= bound;
                    assert!(sum.values.iter().zip(&expected).all(is_near), "{coding:?} {storage:?} {number}");
                    assert_eq!(sum.faces.count_ones(), [3, 0, 2, 6][number]);
                    sum.clear();
                    assert!(sum.values.iter().all(|value| *value == 0.0) && sum.faces == 0);
                }
            }
        }
    }

    #[test]
    fn one_texel_per_face_is_all_mean() {
        let cube = Cube::new(0);
        let vector = Sparse { indices: vec![1, 4], values: vec![0.25, 0.75] };
        for coding in [Coding::Listed, Coding::Tree] {
            let mut sum = Sum::new(cube);
            Rows::store(cube, std::slice::from_ref(&vector), Storage::F32, coding).add(0, 1.0, &mut sum);
            assert_eq!(sum.values, [0.0, 0.25, 0.0, 0.0, 0.75, 0.0]);
        }
    }

    /// A square's byte instead of every coefficient's two.
    #[test]
    fn trees_take_less_where_wavelets_stand_together() {
        let cube = Cube::new(5);
        let square = 1024 + 3;
        let indices: Vec<u16> = vec![1024, 1025, 1026, 1027, square + 4, square + 8, square + 12];
        let vector = [Sparse { values: vec![0.5; indices.len()], indices }];
        let [listed, tree] =
            [Coding::Listed, Coding::Tree].map(|coding| Rows::store(cube, &vector, Storage::U8, coding).bytes.len());
        assert_eq!((listed, tree), (1 + 7 * 3, 1 + 2 + 7));
    }
}
