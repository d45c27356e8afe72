//! Rows by eights.

use halfshade_sh::kernel::LANES;
use wide::f32x8;

/// Rows of equal width; zeros fill up the last eight of each.
#[derive(Debug)]
pub(crate) struct Rows {
    width: usize,
    values: Vec<[f32; LANES]>,
}

impl Rows {
    pub(crate) fn new(values: &[f32], width: usize) -> Self {
        Self { width, values: values.chunks_exact(width).flat_map(eights).collect() }
    }

    /// Numbers of a row.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn len(&self) -> usize {
        self.values.len() / self.width.div_ceil(LANES)
    }

    /// The numbers of a row.
    pub(crate) fn row(&self, number: u32) -> &[f32] {
        &self.eights(number).as_flattened()[..self.width]
    }

    /// The same, filled up with zeros.
    pub(crate) fn eights(&self, number: u32) -> &[[f32; LANES]] {
        let count = self.width.div_ceil(LANES);
        &self.values[number as usize * count..][..count]
    }
}

/// Numbers by eights, the last filled up with zeros.
pub(crate) fn eights(values: &[f32]) -> impl Iterator<Item = [f32; LANES]> {
    values.chunks(LANES).map(|chunk| {
        let mut eight = [0.0; LANES];
        eight[..chunk.len()].copy_from_slice(chunk);
        eight
    })
}

/// Squared distance of two rows.
pub(crate) fn squared_distance(a: &[[f32; LANES]], b: &[[f32; LANES]]) -> f32 {
    let add = |sum: f32x8, (&a, &b): (&[f32; LANES], &[f32; LANES])| {
        let difference = f32x8::from(a) - f32x8::from(b);
        difference.mul_add(difference, sum)
    };
    a.iter().zip(b).fold(f32x8::ZERO, add).reduce_add()
}
