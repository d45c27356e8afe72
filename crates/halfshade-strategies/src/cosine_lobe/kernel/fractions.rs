//! Fractions of cells that discs cover, for `leaves=fraction`, and of a disc that the horizon leaves.

use super::mask::{Cell, Disc};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2};
use wide::f32x8;

/// How much of eight cells of a level discs cover, each as if its edge were straight there and independent of the others':
/// [0, 1].
pub(crate) fn covered_fractions(cells: &[Cell; 8], discs: &[Disc]) -> f32x8 {
    let size = 2.0 / (1 << cells[0].level) as f32;
    let middle = |place: &dyn Fn(&Cell) -> usize| {
        f32x8::from(cells.each_ref().map(|cell| place(cell) as f32 + 0.5)) * f32x8::splat(size) - f32x8::ONE
    };
    let (x, y) = (middle(&|cell| cell.column), middle(&|cell| cell.row));
    // By the diameter of a disc as large as the cell.
    let per_width = (1.128 * size).recip();
    let mut open = f32x8::ONE;
    for disc in discs {
        let (dx, dy) = (x - f32x8::splat(disc.center[0]), y - f32x8::splat(disc.center[1]));
        let distance = dx.mul_add(dx, dy * dy).sqrt();
        // A disc smaller than the cell covers at most its own area.
        let most = (std::f32::consts::PI * disc.radius * disc.radius / (size * size)).min(1.0);
        let covered = (f32x8::splat(disc.radius) - distance).mul_add(f32x8::splat(per_width), f32x8::splat(0.5));
        open *= f32x8::ONE - covered.fast_max(f32x8::ZERO).fast_min(f32x8::splat(most));
    }
    f32x8::ONE - open
}

/// The fraction of a disc above a line at `height` radii below its centre: [0, 1].
pub(crate) fn fraction_above(height: f32) -> f32 {
    let x = height.clamp(-1.0, 1.0);
    FRAC_1_PI * (x * (1.0 - x * x).sqrt() + x.asin() + FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    fn disc(seed: u64) -> Disc {
        let mut random = random(seed);
        Disc { center: [random() * 1.4, random() * 1.4], radius: 0.02 + 0.7 * random().abs().powi(2) }
    }

    #[test]
    fn fractions_are_near_those_of_a_fine_raster() {
        let mut worst = 0.0f32;
        for seed in 0..200 {
            let discs = [disc(seed)];
            let cell = Cell { level: 3, column: seed as usize % 8, row: seed as usize / 8 % 8 };
            let inside = (0..64 * 64).filter(|i| {
                let at = |place: usize, first: usize| (first as f32 + (place as f32 + 0.5) / 64.0) / 4.0 - 1.0;
                let (x, y) = (at(i % 64, cell.column), at(i / 64, cell.row));
                (x - discs[0].center[0]).hypot(y - discs[0].center[1]) < discs[0].radius
            });
            let found = covered_fractions(&[cell; 8], &discs).to_array()[seed as usize % 8];
            worst = worst.max((inside.count() as f32 / 4096.0 - found).abs());
        }
        assert!(worst < 0.2, "{worst}");
    }
}
