//! Rows of four numbers, as kernels read tables. Numbers of both kinds share them: a whole number in the bits of a float could
//! be taken for a denormal one, and be lost.

use glam::Vec3;

/// Four numbers, whole or not.
pub(crate) type Row = [u32; 4];

/// A vector and a number as bits.
pub(crate) fn bits(vector: Vec3, last: f32) -> Row {
    vector.extend(last).to_array().map(f32::to_bits)
}

/// Rows of four, the last filled up with zeros.
pub(crate) fn fours(numbers: impl Iterator<Item = u32>) -> impl Iterator<Item = Row> {
    let mut numbers = numbers.peekable();
    std::iter::from_fn(move || {
        numbers.peek()?;
        Some(std::array::from_fn(|_| numbers.next().unwrap_or(0)))
    })
}
