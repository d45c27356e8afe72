//! The grid of directions over which radiance is fitted.

use std::f64::consts::{PI, TAU};

/// Cells of the grid, 5.6 degrees wide.
pub(super) const COLUMNS: usize = 64;
pub(super) const ROWS: usize = 32;
pub(super) const CELLS: usize = COLUMNS * ROWS;

/// The middle of a cell.
pub(super) fn direction(cell: usize) -> [f64; 3] {
    let polar = PI * ((cell / COLUMNS) as f64 + 0.5) / ROWS as f64;
    let azimuth = TAU * (((cell % COLUMNS) as f64 + 0.5) / COLUMNS as f64 - 0.5);
    [polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()]
}

pub(super) fn solid_angle(cell: usize) -> f64 {
    let edge = |row: usize| (PI * row as f64 / ROWS as f64).cos();
    TAU / COLUMNS as f64 * (edge(cell / COLUMNS) - edge(cell / COLUMNS + 1))
}

/// The image's mean over each cell of the grid, by the solid angle that each texel has in it.
pub(super) fn averaged(width: usize, height: usize, texels: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let rows = overlaps(height, ROWS, |t| -(PI * t).cos());
    let columns = overlaps(width, COLUMNS, |t| t);
    let mut sums = vec![[0.0; 3]; CELLS];
    for &(row, cell_row, tall) in &rows {
        for &(column, cell_column, wide) in &columns {
            let sum = &mut sums[cell_row * COLUMNS + cell_column];
            for (sum, value) in sum.iter_mut().zip(texels[row * width + column]) {
                // NaN fails the comparison.
                if value > 0.0 && value.is_finite() {
                    *sum += tall * wide * f64::from(value);
                }
            }
        }
    }
    sums
}

/// Overlaps of `from` intervals of [0, 1] with `to` others, and what part of the latter's measure each is.
fn overlaps(from: usize, to: usize, measure: impl Fn(f64) -> f64) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::with_capacity(from + to);
    let (mut i, mut j) = (0, 0);
    while i < from && j < to {
        let low = (i as f64 / from as f64).max(j as f64 / to as f64);
        let (end, cell_end) = ((i + 1) * to, (j + 1) * from);
        let high = end.min(cell_end) as f64 / (from * to) as f64;
        let whole = measure((j + 1) as f64 / to as f64) - measure(j as f64 / to as f64);
        found.push((i, j, (measure(high) - measure(low)) / whole));
        i += usize::from(end <= cell_end);
        j += usize::from(cell_end <= end);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_average_keeps_power() {
        for (width, height) in [(1, 1), (3, 7), (64, 32), (100, 47), (200, 90)] {
            let texels: Vec<[f32; 3]> =
                (0..width * height).map(|i| [(i * 7 % 11) as f32, 1.0, (i % 3) as f32]).collect();
            let cells = averaged(width, height, &texels);
            let edge = |row: usize| (PI * row as f64 / height as f64).cos();
            let power = |channel: usize| {
                let of =
                    |i: usize| f64::from(texels[i][channel]) * (edge(i / width) - edge(i / width + 1)) / width as f64;
                TAU * (0..width * height).map(of).sum::<f64>()
            };
            for channel in 0..3 {
                let found: f64 = cells.iter().enumerate().map(|(i, cell)| solid_angle(i) * cell[channel]).sum();
                assert!((found - power(channel)).abs() <= 1e-9 * found, "{width} {height}");
            }
        }
    }
}
