//! How much of each cell of a hemisphere blockers cover.
//!
//! The hemisphere is the unit disc of its square (see `square.rs`), blockers are discs, cells a grid over the square. A cell
//! counts as a disc of its area. Of two discs of radii c and R whose centres are d apart, the part of the first that the
//! second covers is taken as linear in d between where they touch and where one holds the other; blockers cover
//! independently of each other.

use super::mask::Disc;
use std::f32::consts::{FRAC_1_PI, PI};
use wide::f32x8;

/// Discs smaller than this part of a cell's width fade in as if they were as large, so that none slips between cells.
const SMALLEST: f32 = 0.25;

const LANES: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

/// The open part of each cell, [0, 1], in groups of eight along a row, row by row.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cover {
    side: usize,
    open: Vec<f32x8>,
}

impl Cover {
    /// All of `side` by `side` cells are open; a side is a multiple of eight.
    pub(crate) fn clear(&mut self, side: usize) {
        self.side = side;
        self.open.clear();
        self.open.resize(side * side / 8, f32x8::ONE);
    }

    pub(crate) fn open(&self) -> &[f32x8] {
        &self.open
    }

    /// Covers what is behind a disc.
    pub(crate) fn splat(&mut self, disc: &Disc) {
        let half = 0.5 * self.side as f32;
        // In cells, from the first one's middle.
        let [x, y] = disc.center.map(|coordinate| (coordinate + 1.0) * half - 0.5);
        let radius = disc.radius * half;
        let cell = FRAC_1_PI.sqrt();
        let reach = radius.max(SMALLEST) + cell;
        // A disc covers at most its own area.
        let most = f32x8::splat((PI * radius * radius).min(1.0));
        let slope = (2.0 * radius.clamp(SMALLEST, cell)).recip();
        let groups = self.side / 8;
        let cell_at = |place: f32| (place.max(0.0) as usize).min(self.side);
        let rows = cell_at((y - reach).ceil())..cell_at((y + reach).floor() + 1.0);
        // The same groups in every row: most discs are small, and a root per row would cost more than what it left out.
        let columns = cell_at((x - reach).ceil()) / 8..cell_at((x + reach).floor() + 1.0).div_ceil(8);
        let first = f32x8::splat((8 * columns.start) as f32 - x) + LANES;
        for row in rows {
            let dy = row as f32 - y;
            let mut dx = first;
            for open in &mut self.open[row * groups..][columns.clone()] {
                let distance = dx.mul_add(dx, f32x8::splat(dy * dy)).sqrt();
                let covered = (f32x8::splat(reach) - distance) * f32x8::splat(slope);
                let covered = covered.fast_max(f32x8::ZERO).fast_min(f32x8::ONE) * most;
                *open = covered.mul_neg_add(*open, *open);
                dx += f32x8::splat(8.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    fn open_at(cover: &Cover, column: usize, row: usize) -> f32 {
        let i = row * cover.side + column;
        cover.open()[i / 8].to_array()[i % 8]
    }

    /// By a raster of 64 by 64 points in each cell.
    fn sampled(disc: &Disc, side: usize, column: usize, row: usize) -> f32 {
        let inside = (0..64 * 64).filter(|i| {
            let at = |cell: usize, step: usize| 2.0 * (cell as f32 + (step as f32 + 0.5) / 64.0) / side as f32 - 1.0;
            (at(column, i % 64) - disc.center[0]).hypot(at(row, i / 64) - disc.center[1]) < disc.radius
        });
        inside.count() as f32 / 4096.0
    }

    #[test]
    fn one_disc_covers_what_a_raster_says() {
        let mut random = random(1);
        let (mut worst, mut worst_area) = (0.0f32, 0.0f32);
        let mut cover = Cover::default();
        for case in 0..150 {
            let side = [8, 16, 32][case % 3];
            let radius = if case % 7 == 0 { 300.0 } else { 0.8 * random().abs().powi(2) + 0.005 };
            let turn = 3.0 * random();
            let away = if radius > 1.0 { radius + random() } else { random() };
            let disc = Disc { center: [away * turn.cos(), away * turn.sin()], radius };
            cover.clear(side);
            cover.splat(&disc);
            let (mut found, mut exact) = (0.0, 0.0);
            for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
                let (covered, sampled) = (1.0 - open_at(&cover, column, row), sampled(&disc, side, column, row));
                worst = worst.max((covered - sampled).abs());
                found += covered;
                exact += sampled;
            }
            // In cells: a small disc may lie between two or four that each take it for theirs.
            worst_area = worst_area.max((found - exact).abs() / (1.0 + 0.05 * exact));
        }
        assert!(worst < 0.2 && worst_area < 0.5, "{worst} {worst_area}");
    }

    #[test]
    fn covers_multiply_and_damaged_discs_do_no_harm() {
        let mut cover = Cover::default();
        cover.clear(16);
        let disc = Disc { center: [0.1, -0.2], radius: 0.31 };
        cover.splat(&disc);
        let once = cover.clone();
        cover.splat(&disc);
        for (once, twice) in once.open().iter().zip(cover.open()) {
            let difference = (*once * *once - *twice).abs();
            assert!(difference.to_array().into_iter().all(|difference| difference < 1e-6));
        }
        for bad in [f32::NAN, f32::INFINITY, -1.0, 0.0, f32::MAX] {
            cover.splat(&Disc { center: [bad, 0.3], radius: 0.1 });
            cover.splat(&Disc { center: [0.3, -bad], radius: 1e-9 });
            cover.splat(&Disc { center: [0.3, 0.1], radius: bad });
        }
        assert!(cover.open().iter().all(|open| open.to_array().into_iter().all(|x| (0.0..=1.0).contains(&x))));
        cover.splat(&Disc { center: [900.0, 0.0], radius: 902.0 });
        assert!(cover.open().iter().all(|open| *open == f32x8::ZERO));
    }
}
