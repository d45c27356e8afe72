//! The visibility mask: which cells of the square before a light are in shadow, as a quad-tree [Meunier2009, 5.3].
//!
//! The light is the unit disc, the square around it is [-1, 1]², blockers are discs (see `square.rs`). The tree is not walked
//! down but built from its finest cells: one bit each, a row of cells a word. A disc covers, in each row, the columns between
//! its chords at the row's edges, and touches those between its widest chords within the row. Four covered siblings are then
//! one covered parent. The leaves are those of the paper, and where several discs cover a parent's children, one leaf.

use wide::{f32x8, i32x8};

/// Finest level: a row of its cells is a word.
pub(crate) const MAX_DEPTH: usize = 6;

const MOST_ROWS: usize = 1 << MAX_DEPTH;

/// One level's cells, row by row.
type Rows = [u64; MOST_ROWS];

/// A blocker on the square, in radii of the light's disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Disc {
    pub(crate) center: [f32; 2],
    pub(crate) radius: f32,
}

impl Disc {
    /// Whether it covers all of the light.
    pub(crate) fn hides_light(&self) -> bool {
        let [x, y] = self.center;
        self.radius >= 1.0 && x.hypot(y) + 1.0 <= self.radius
    }
}

/// A cell of the square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cell {
    /// 0 is the whole square.
    pub(crate) level: usize,
    pub(crate) column: usize,
    pub(crate) row: usize,
}

/// Finest cells, eight rows side by side: the 32 columns on the left, then those on the right.
#[derive(Debug, Clone)]
struct Raster([[i32x8; MOST_ROWS / 8]; 2]);

impl Raster {
    const EMPTY: Self = Self([[i32x8::ZERO; MOST_ROWS / 8]; 2]);

    /// Adds the columns from `low` to before `high` of each row of a group.
    #[inline(always)]
    fn add(&mut self, group: usize, low: f32x8, high: f32x8, columns: f32) {
        for (half, first) in self.0.iter_mut().zip([0.0, 32.0]) {
            let end = f32x8::splat((columns - first).clamp(0.0, 32.0));
            let place = |column: f32x8| (column - f32x8::splat(first)).max(f32x8::ZERO).min(end).fast_trunc_int();
            half[group] |= bits_below(place(high)) & !bits_below(place(low));
        }
    }

    fn rows(&self) -> Rows {
        let [left, right] = self.0.each_ref().map(|groups| groups.map(i32x8::to_array));
        std::array::from_fn(|row| {
            let word = |half: &[[i32; 8]; MOST_ROWS / 8]| u64::from(half[row / 8][row % 8] as u32);
            word(&left) | word(&right) << 32
        })
    }
}

/// The lowest `count` bits of each lane, 0 to 32.
#[inline(always)]
fn bits_below(count: i32x8) -> i32x8 {
    // A shift by 32 is one by 0.
    ((i32x8::ONE << count) - i32x8::ONE) | count.simd_eq(i32x8::splat(32))
}

/// Cells in shadow, level by level.
#[derive(Debug, Clone)]
pub(crate) struct Mask {
    depth: usize,
    /// Finest cells that discs cover, and that they touch.
    whole: Raster,
    part: Raster,
    /// The same, and what is joined of it.
    covered: [Rows; MAX_DEPTH + 1],
    touched: Rows,
}

impl Mask {
    /// A mask of `depth` levels below the root, at most [`MAX_DEPTH`].
    pub(crate) fn new(depth: usize) -> Self {
        Self {
            depth: depth.min(MAX_DEPTH),
            whole: Raster::EMPTY,
            part: Raster::EMPTY,
            covered: [[0; MOST_ROWS]; MAX_DEPTH + 1],
            touched: [0; MOST_ROWS],
        }
    }

    /// Nothing is covered.
    pub(crate) fn clear(&mut self) {
        self.whole = Raster::EMPTY;
        self.part = Raster::EMPTY;
    }

    /// Adds a disc to the finest cells.
    pub(crate) fn splat(&mut self, disc: &Disc) {
        let rows = 1usize << self.depth;
        let columns = rows as f32;
        let half = 0.5 * columns;
        let [x, y] = disc.center.map(|coordinate| (coordinate + 1.0) * half);
        let radius = disc.radius * half;
        let row_at = |y: f32| (y.max(0.0) as usize).min(rows);
        let (first, end) = (row_at((y - radius).floor()), row_at((y + radius).ceil()));
        let [x8, y8, radius8] = [x, y, radius].map(f32x8::splat);
        // As a product of sum and difference: a disc may be far larger than the square.
        let half_chord = |distance: f32x8| ((radius8 - distance) * (radius8 + distance)).max(f32x8::ZERO).sqrt();
        for group in first / 8..end.div_ceil(8) {
            let bottom = f32x8::splat((8 * group) as f32) + f32x8::from([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
            let (below, above) = (bottom - y8, bottom + f32x8::ONE - y8);
            let far = below.abs().fast_max(above.abs());
            let near = below.fast_max(-above).fast_max(f32x8::ZERO);
            let (narrow, wide) = (half_chord(far), half_chord(near));
            // A row that the disc doesn't reach has no columns.
            let high = |distance: f32x8, high: f32x8| distance.simd_lt(radius8).select(high, f32x8::ZERO);
            self.whole.add(group, (x8 - narrow).ceil(), high(far, (x8 + narrow).floor()), columns);
            self.part.add(group, (x8 - wide).floor(), high(near, (x8 + wide).ceil()), columns);
        }
    }

    /// Counts what is touched as covered.
    pub(crate) fn cover_touched(&mut self) {
        self.whole = self.part.clone();
    }

    /// Joins siblings, whose cells without light count as covered. Returns whether all that has light is covered.
    pub(crate) fn join(&mut self, unlit: &Unlit) -> bool {
        self.covered[self.depth] = self.whole.rows();
        self.touched = self.part.rows();
        for level in (0..=self.depth).rev() {
            for row in 0..1 << level {
                let joined = if level == self.depth {
                    self.covered[level][row]
                } else {
                    let both = self.covered[level + 1][2 * row] & self.covered[level + 1][2 * row + 1];
                    every_other(both & (both >> 1))
                };
                self.covered[level][row] = joined | unlit.levels[level][row];
            }
        }
        self.covered[0][0] & 1 == 1
    }

    /// Calls for every leaf that is covered and has light, coarse ones first, after [`Self::join`].
    pub(crate) fn each_leaf(&self, unlit: &Unlit, mut work: impl FnMut(Cell)) {
        for level in 0..=self.depth {
            for row in 0..1 << level {
                let within_parent = if level == 0 { 0 } else { doubled(self.covered[level - 1][row / 2]) };
                each_bit(self.covered[level][row] & !within_parent & !unlit.levels[level][row], |column| {
                    work(Cell { level, column, row });
                });
            }
        }
    }

    /// Calls for every finest cell that is touched, has light and isn't covered, after [`Self::join`].
    pub(crate) fn each_partial(&self, mut work: impl FnMut(Cell)) {
        let level = self.depth;
        for row in 0..1 << level {
            each_bit(self.touched[row] & !self.covered[level][row], |column| work(Cell { level, column, row }));
        }
    }
}

/// Cells outside the light's disc, level by level.
#[derive(Debug, Clone)]
pub(crate) struct Unlit {
    levels: [Rows; MAX_DEPTH + 1],
}

impl Unlit {
    /// The cells for which `is_unlit` holds.
    pub(crate) fn new(depth: usize, is_unlit: impl Fn(Cell) -> bool) -> Self {
        let mut levels = [[0; MOST_ROWS]; MAX_DEPTH + 1];
        for (level, rows) in levels.iter_mut().enumerate().take(depth + 1) {
            for (row, bits) in rows.iter_mut().enumerate().take(1 << level) {
                let unlit = (0..1usize << level).filter(|&column| is_unlit(Cell { level, column, row }));
                *bits = unlit.fold(0, |bits, column| bits | 1 << column);
            }
        }
        Self { levels }
    }
}

/// Bits 0, 2, 4 and so on, side by side.
#[inline(always)]
fn every_other(bits: u64) -> u64 {
    let mut bits = bits & 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0xffff_ffff),
    ] {
        bits = (bits | (bits >> shift)) & mask;
    }
    bits
}

/// Every bit of the lower half twice.
#[inline(always)]
fn doubled(bits: u64) -> u64 {
    let mut bits = bits & 0xffff_ffff;
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | (bits << shift)) & mask;
    }
    bits | (bits << 1)
}

#[inline(always)]
fn each_bit(mut bits: u64, mut work: impl FnMut(usize)) {
    while bits != 0 {
        work(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    fn discs(seed: u64, count: usize) -> Vec<Disc> {
        let mut random = random(seed);
        (0..count)
            .map(|_| Disc { center: [random() * 1.4, random() * 1.4], radius: 0.02 + 0.7 * random().abs().powi(2) })
            .collect()
    }

    /// Corners and edges of a cell against one disc, in double precision.
    fn brute(cell: Cell, disc: &Disc) -> (bool, bool) {
        let size = 2.0 / f64::from(1 << cell.level);
        let low = [cell.column, cell.row].map(|i| i as f64 * size - 1.0);
        let [dx, dy] = [0, 1].map(|axis| f64::from(disc.center[axis]) - low[axis]);
        let (near, far) = ([dx, dy].map(|d| d - d.clamp(0.0, size)), [dx, dy].map(|d| d.abs().max((d - size).abs())));
        let within = |[x, y]: [f64; 2]| x.hypot(y) < f64::from(disc.radius);
        (within(far), within(near))
    }

    #[test]
    fn finest_cells_are_those_of_a_raster() {
        for depth in 1..=MAX_DEPTH {
            let (mut differing, mut found_covered, mut found_touched) = (0, 0, 0);
            for seed in 0..40 {
                let discs = discs(seed, 5);
                let mut mask = Mask::new(depth);
                mask.clear();
                discs.iter().for_each(|disc| mask.splat(disc));
                let (whole, part) = (mask.whole.rows(), mask.part.rows());
                for (row, column) in (0..1 << depth).flat_map(|row| (0..1 << depth).map(move |column| (row, column))) {
                    let cell = Cell { level: depth, column, row };
                    let covered = discs.iter().any(|disc| brute(cell, disc).0);
                    let touched = discs.iter().any(|disc| brute(cell, disc).1);
                    let bit = |rows: &Rows| rows[row] >> column & 1 == 1;
                    differing += usize::from(covered != bit(&whole) || touched != bit(&part));
                    found_covered += usize::from(covered);
                    found_touched += usize::from(touched);
                }
            }
            // Edges that miss a corner by a rounding.
            assert!(differing <= 2, "{differing} at depth {depth}");
            assert!((depth == 1 || found_covered > 0) && found_touched > found_covered);
        }
    }

    #[test]
    fn leaves_cover_what_finest_cells_cover_and_none_twice() {
        for seed in 0..40 {
            let depth = 1 + seed as usize % MAX_DEPTH;
            let mut mask = Mask::new(depth);
            mask.clear();
            discs(seed, 9).iter().for_each(|disc| mask.splat(disc));
            let finest = mask.whole.rows();
            let unlit = Unlit::new(depth, |cell| cell.level == depth && cell.column + cell.row < 2);
            mask.join(&unlit);
            let mut rebuilt: Rows = [0; MOST_ROWS];
            mask.each_leaf(&unlit, |cell| {
                let size = 1 << (depth - cell.level);
                for bits in &mut rebuilt[size * cell.row..size * (cell.row + 1)] {
                    for column in size * cell.column..size * (cell.column + 1) {
                        assert_eq!(*bits >> column & 1, 0);
                        *bits |= 1 << column;
                    }
                }
            });
            for row in 0..1 << depth {
                let outside = unlit.levels[depth][row];
                assert_eq!(rebuilt[row] | outside, finest[row] | outside);
            }
        }
    }

    #[test]
    fn one_disc_over_everything_is_one_leaf_and_damaged_discs_do_no_harm() {
        let mut mask = Mask::new(5);
        let unlit = Unlit::new(5, |_| false);
        mask.clear();
        mask.splat(&Disc { center: [0.1, -0.2], radius: 0.5 });
        let sound = [mask.whole.rows(), mask.part.rows()];
        assert!(sound.iter().all(|rows| rows.iter().any(|bits| *bits != 0)));
        // Coordinates that are no numbers, or so large that the disc lies nowhere near.
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -f32::MAX] {
            mask.splat(&Disc { center: [bad, 0.3], radius: 0.1 });
            mask.splat(&Disc { center: [0.3, bad], radius: 0.1 });
            mask.splat(&Disc { center: [0.3, bad], radius: 1e-9 });
            assert_eq!([mask.whole.rows(), mask.part.rows()], sound, "{bad}");
        }
        // Discs at a cell's corner and at the square's edge that are smaller than any cell.
        for corner in [-1.0, 0.0, 1.0] {
            mask.splat(&Disc { center: [0.3, corner], radius: 1e-9 });
            assert_eq!(mask.whole.rows(), sound[0], "{corner}");
        }
        mask.clear();
        mask.splat(&Disc { center: [900.0, 0.0], radius: 902.0 });
        assert!(mask.join(&unlit));
        let mut leaves = Vec::new();
        mask.each_leaf(&unlit, |cell| leaves.push(cell));
        assert_eq!(leaves, [Cell { level: 0, column: 0, row: 0 }]);
    }
}
