//! Rows of four numbers, as kernels read tables. Numbers of both kinds share them: a whole number in the bits of a float could
//! be taken for a denormal one, and be lost.

use glam::Vec3;

/// Four numbers, whole or not.
pub(crate) type Row = [u32; 4];

/// A vector and a number.
pub(crate) fn row(vector: Vec3, last: f32) -> [f32; 4] {
    vector.extend(last).to_array()
}

/// A vector and a number as bits.
pub(crate) fn bits(vector: Vec3, last: f32) -> Row {
    row(vector, last).map(f32::to_bits)
}

/// The first numbers of a list, and zeros where it ends.
pub(crate) fn filled<const N: usize>(values: &[f32]) -> [f32; N] {
    std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0))
}

/// Rows of four, the last filled up with zeros.
pub(crate) fn fours(numbers: impl Iterator<Item = u32>) -> impl Iterator<Item = Row> {
    let mut numbers = numbers.peekable();
    std::iter::from_fn(move || {
        numbers.peek()?;
        Some(std::array::from_fn(|_| numbers.next().unwrap_or(0)))
    })
}

/// A vector in rows of four, filled up with zeros.
pub(crate) fn in_fours(vector: &[f32]) -> impl Iterator<Item = [f32; 4]> {
    vector.chunks(4).map(filled)
}
