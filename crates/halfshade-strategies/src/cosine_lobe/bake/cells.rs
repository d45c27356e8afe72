//! The cells that the square before a light is divided into, level by level, and the light that each has
//! [Meunier2009, 5.3, figure 8].

use crate::cosine_lobe::kernel::{
    cell_lobes::LitCell,
    mask::{Cell, Unlit},
};
use std::f32::consts::PI;

/// The cells of all levels.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    levels: Vec<Vec<LitCell>>,
    pub(crate) unlit: Unlit,
}

impl Cells {
    /// Cells of `depth` levels below the root.
    pub(crate) fn new(depth: usize) -> Self {
        let mut finest = finest(depth);
        let mut levels = Vec::with_capacity(depth + 1);
        for level in (0..depth).rev() {
            let side = 1usize << level;
            let joined = |i: usize| {
                let (row, column) = (2 * (i / side), 2 * (i % side));
                let children = [(row, column), (row, column + 1), (row + 1, column), (row + 1, column + 1)];
                sum(children.map(|(row, column)| finest[row * 2 * side + column]))
            };
            let coarser = (0..side * side).map(joined).collect();
            levels.push(std::mem::replace(&mut finest, coarser));
        }
        levels.push(finest);
        levels.reverse();
        let unlit = Unlit::new(depth, |cell| at(&levels, cell).area <= 0.0);
        Self { levels, unlit }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.as_slice())).sum::<usize>() + size_of::<Unlit>()
    }

    #[inline(always)]
    pub(crate) fn at(&self, cell: Cell) -> LitCell {
        at(&self.levels, cell)
    }

    /// The lit cells of one level.
    pub(crate) fn level(&self, level: usize) -> impl Iterator<Item = &LitCell> {
        self.levels[level.min(self.levels.len() - 1)].iter().filter(|cell| cell.area > 0.0)
    }
}

#[inline(always)]
fn at(levels: &[Vec<LitCell>], cell: Cell) -> LitCell {
    levels[cell.level][(cell.row << cell.level) + cell.column]
}

fn sum(cells: [LitCell; 4]) -> LitCell {
    let area: f32 = cells.iter().map(|cell| cell.area).sum();
    let middle = |axis: usize| cells.iter().map(|cell| cell.area * cell.middle[axis]).sum::<f32>() / area;
    if area > 0.0 { LitCell { area, middle: [middle(0), middle(1)] } } else { LitCell::default() }
}

/// The finest cells, by the midpoint rule over each cell's width; areas scaled to a sum of π.
fn finest(depth: usize) -> Vec<LitCell> {
    const STEPS: usize = 64;
    let side = 1usize << depth;
    let size = 2.0 / side as f64;
    let mut cells: Vec<LitCell> = (0..side * side)
        .map(|i| {
            let (left, bottom) = ((i % side) as f64 * size - 1.0, (i / side) as f64 * size - 1.0);
            let (mut area, mut moments) = (0.0, [0.0; 2]);
            for step in 0..STEPS {
                let x = left + (step as f64 + 0.5) / STEPS as f64 * size;
                let half = (1.0 - x * x).max(0.0).sqrt();
                let (low, high) = (bottom.max(-half), (bottom + size).min(half));
                let strip = (high - low).max(0.0) * size / STEPS as f64;
                area += strip;
                moments[0] += strip * x;
                moments[1] += strip * 0.5 * (low + high);
            }
            let middle = if area > 0.0 { moments.map(|moment| (moment / area) as f32) } else { [0.0; 2] };
            LitCell { area: area as f32, middle }
        })
        .collect();
    let scale = PI / cells.iter().map(|cell| cell.area).sum::<f32>();
    cells.iter_mut().for_each(|cell| cell.area *= scale);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_share_the_disc() {
        let cells = Cells::new(5);
        for level in 0..=5 {
            let (area, x): (f32, f32) =
                cells.level(level).fold((0.0, 0.0), |(area, x), c| (area + c.area, x + c.area * c.middle[0]));
            assert!((area - PI).abs() < 1e-4 && x.abs() < 1e-4);
        }
        let inner = cells.at(Cell { level: 3, column: 3, row: 4 });
        assert!((inner.area - 1.0 / 16.0).abs() < 1e-4 && (inner.middle[0] + 0.125).abs() < 1e-4);
        assert_eq!(cells.at(Cell { level: 4, column: 0, row: 15 }).area, 0.0);
    }
}
