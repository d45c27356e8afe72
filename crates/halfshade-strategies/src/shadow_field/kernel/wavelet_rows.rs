//! Rows of wavelets as they are stored, decoded and added up.
//!
//! A row starts with the faces that it has anything on, as bits. Then follow values and where they belong: each with its
//! number, or as a tree of squares, whose byte tells by bits which wavelets and which quarters there are. In either a
//! coefficient is `least + step · value` with the scale of its level.

/// The bit of a tree's root that says that the mean follows.
pub(crate) const MEAN: u8 = 1 << 7;

/// Level of a coefficient, 0 for the mean, by its number on its face.
pub(crate) fn level(face_len: usize, index: u16) -> usize {
    let on_face = usize::from(index) & (face_len - 1);
    on_face.checked_ilog2().map_or(0, |log| log as usize / 2 + 1)
}

/// A square of a face by its number among the `count` of its level (see `halfshade_sh::haar::transform`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Square {
    pub(crate) number: usize,
    pub(crate) count: usize,
    pub(crate) level: usize,
}

impl Square {
    pub(crate) const WHOLE: Self = Self { number: 0, count: 1, level: 0 };

    /// Numbers of its coefficients.
    #[inline(always)]
    pub(crate) fn wavelets(self) -> impl Iterator<Item = usize> {
        (1..4).map(move |way| self.number + way * self.count)
    }

    /// The four squares of the next level within it.
    #[inline(always)]
    pub(crate) fn quarters(self) -> impl Iterator<Item = Self> {
        (0..4).map(move |quarter| Self {
            number: self.number + quarter * self.count,
            count: 4 * self.count,
            level: self.level + 1,
        })
    }
}

/// One row; `number` is a value as it is stored.
pub(crate) struct RowReader<'a, const BYTES: usize, N> {
    pub(crate) bytes: &'a [u8],
    /// Coefficients of a face.
    pub(crate) face_len: usize,
    /// Least value and step by level.
    pub(crate) scale: &'a [[f32; 2]],
    pub(crate) weight: f32,
    pub(crate) number: N,
}

impl<const BYTES: usize, N: Fn([u8; BYTES]) -> f32> RowReader<'_, BYTES, N> {
    /// The next bytes; none are missing in a row.
    #[inline(always)]
    fn take<const COUNT: usize>(&mut self) -> [u8; COUNT] {
        let Some((first, rest)) = self.bytes.split_first_chunk() else { return [0; COUNT] };
        self.bytes = rest;
        *first
    }

    /// Adds the next value, by a level's scale.
    #[inline(always)]
    fn add(&mut self, [least, step]: [f32; 2], value: &mut f32) {
        let bytes = self.take();
        *value += self.weight * (self.number)(bytes).mul_add(step, least);
    }

    /// Adds a row of listed coefficients to those of all faces; returns its faces, as bits.
    #[inline(always)]
    pub(crate) fn add_listed(mut self, values: &mut [f32]) -> u8 {
        let [faces] = self.take();
        while !self.bytes.is_empty() {
            let index = u16::from_le_bytes(self.take());
            self.add(self.scale[level(self.face_len, index)], &mut values[usize::from(index)]);
        }
        faces
    }

    /// The same of a row of trees.
    #[inline(always)]
    pub(crate) fn add_tree(mut self, values: &mut [f32]) -> u8 {
        let [faces] = self.take();
        for (face, values) in values.chunks_exact_mut(self.face_len).enumerate() {
            if faces & (1 << face) != 0 {
                self.add_square(Square::WHOLE, values);
            }
        }
        faces
    }

    fn add_square(&mut self, square: Square, face: &mut [f32]) {
        let [present] = self.take();
        if present & MEAN != 0 {
            self.add(self.scale[0], &mut face[0]);
        }
        if present & 0b111 != 0 {
            let scale = self.scale[square.level + 1];
            for (bit, index) in square.wavelets().enumerate() {
                if present & (1 << bit) != 0 {
                    self.add(scale, &mut face[index]);
                }
            }
        }
        for (bit, quarter) in square.quarters().enumerate() {
            if present & (1 << (3 + bit)) != 0 {
                self.add_square(quarter, face);
            }
        }
    }
}
