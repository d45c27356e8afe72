//! Weights against the overlap of neighbouring lobes [Meunier2009, 5.3, eq. 39].
//!
//! Lobes of bounding spheres overlap, the more so the larger the light, and the light's lobe reaches past its cone. The paper
//! sets w by eye, per level and distance of the square: full darkness in the umbra first, then each level so that it joins the
//! one before. Both mean that a level's leaves, all in shadow, hide the whole light, which is a formula, `weights=umbra`:
//!
//! ```text
//! w(level, dist) = ∫ c_light / Σ_i ∫ c_light c_i       over the level's cells that have light
//! ```
//!
//! `weights=fitted` has, per distance, the weights of all levels that come nearest to the truth by least squares for one light,
//! one blocker and one plane that faces the light: discs of several sizes that cover it from many sides to many degrees, and
//! what each hides of it exactly. Levels that hardly occur are held near the umbra's weight.
//!
//! Both are found when tables are built, in a fraction of a second, at the paper's distances, and are linear in between.

use super::cells::Cells;
use crate::cosine_lobe::{
    kernel::{
        cell_lobes::{CellLobes, Shape, light_lobe},
        fractions::covered_fractions,
        mask::{Cell, Disc, MAX_DEPTH, Mask},
        square::Square,
    },
    settings::{Leaves, Settings, Weights},
};
use halfshade_sh::lobe::{CapLobeTable, Lobe8, LobeTable};
use std::array::from_fn;
use wide::f32x8;

/// `dist` of [Meunier2009, 5.3].
const DISTANCES: [f32; 12] = [0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];

/// Weights by level.
type ByLevel = [f64; MAX_DEPTH + 1];

/// w by distance and level.
#[derive(Debug, Clone)]
pub(crate) struct WeightTable([[f32; MAX_DEPTH + 1]; DISTANCES.len()]);

/// Settings and tables that weights are found with.
#[derive(Clone, Copy)]
struct Finding<'a> {
    settings: &'a Settings,
    cells: &'a Cells,
    caps: &'a CapLobeTable,
    table: &'a LobeTable,
}

impl WeightTable {
    /// Weights of the published order, for masks as `settings` has them.
    pub(crate) fn new(settings: &Settings, cells: &Cells, caps: &CapLobeTable, table: &LobeTable) -> Self {
        let finding = Finding { settings, cells, caps, table };
        Self(DISTANCES.map(|distance| {
            // tan σ = 1/(2 dist), of a light at distance 1.
            let sine = (1.0 + 4.0 * distance * distance).sqrt().recip();
            let weights = match (Square::new([0.0, 1.0, 0.0], sine), settings.weights) {
                (None, _) | (_, Weights::SolidAngle) => [1.0; MAX_DEPTH + 1],
                (Some(square), Weights::Umbra) => finding.umbra(&square),
                (Some(square), Weights::Fitted) => finding.fitted(&square),
            };
            weights.map(|weight| weight as f32)
        }))
    }

    /// All 1, where no weights are needed.
    pub(crate) fn ones() -> Self {
        Self([[1.0; MAX_DEPTH + 1]; DISTANCES.len()])
    }

    /// Linear in the distance, constant beyond the table.
    pub(crate) fn at(&self, level: usize, distance: f32) -> f32 {
        let above = DISTANCES.partition_point(|&known| known <= distance).clamp(1, DISTANCES.len() - 1);
        let (low, high) = (DISTANCES[above - 1], DISTANCES[above]);
        let part = ((distance - low) / (high - low)).clamp(0.0, 1.0);
        (1.0 - part) * self.0[above - 1][level] + part * self.0[above][level]
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.0)
    }
}

impl Finding<'_> {
    fn umbra(&self, square: &Square) -> ByLevel {
        let light = light_lobe(square, self.caps);
        from_fn(|level| {
            if level > self.settings.depth {
                return 1.0;
            }
            let mut lobes = CellLobes::default();
            self.cells.level(level).for_each(|&cell| lobes.push(cell, level, 1.0, square, Shape::Bounding(self.caps)));
            f64::from(light.integral().to_array()[0] / self.hidden(&light, &mut lobes, square).max(f32::MIN_POSITIVE))
        })
    }

    fn fitted(&self, square: &Square) -> ByLevel {
        let light = light_lobe(square, self.caps);
        let whole = f64::from(light.integral().to_array()[0]);
        let umbra = self.umbra(square);
        let mut matrix = [[0.0; MAX_DEPTH + 1]; MAX_DEPTH + 1];
        let mut right = [0.0; MAX_DEPTH + 1];
        for disc in discs() {
            let by_level = self.hidden_by_level(&light, square, &disc);
            let exact = whole * exactly_hidden(square, &disc);
            for (i, row) in matrix.iter_mut().enumerate() {
                (0..=MAX_DEPTH).for_each(|j| row[j] += by_level[i] * by_level[j]);
                right[i] += by_level[i] * exact;
            }
        }
        let firmness = 1e-3 * (0..=MAX_DEPTH).map(|i| matrix[i][i]).sum::<f64>().max(f64::MIN_POSITIVE);
        for i in 0..=MAX_DEPTH {
            matrix[i][i] += firmness;
            right[i] += firmness * umbra[i];
        }
        solve(matrix, right)
    }

    /// `Σ ∫ c_light c_i` of one level's leaves.
    fn hidden_by_level(&self, light: &Lobe8, square: &Square, disc: &Disc) -> ByLevel {
        let depth = self.settings.depth;
        let mut mask = Mask::new(depth);
        mask.clear();
        mask.splat(disc);
        if self.settings.leaves == Leaves::Conservative {
            mask.cover_touched();
        }
        mask.join(&self.cells.unlit);
        let mut lobes: [CellLobes; MAX_DEPTH + 1] = Default::default();
        let mut push = |cell: Cell, weight: f32| {
            lobes[cell.level].push(self.cells.at(cell), cell.level, weight, square, Shape::Bounding(self.caps));
        };
        mask.each_leaf(&self.cells.unlit, |cell| push(cell, 1.0));
        if self.settings.leaves == Leaves::Fraction {
            mask.each_partial(|cell| push(cell, covered_fractions(&[cell; 8], &[*disc]).to_array()[0]));
        }
        from_fn(|level| f64::from(self.hidden(light, &mut lobes[level], square)))
    }

    fn hidden(&self, light: &Lobe8, lobes: &mut CellLobes, square: &Square) -> f32 {
        lobes.flush(square, Shape::Bounding(self.caps));
        lobes.integral(light, self.table, None, &mut [0; 2])
    }
}

/// Blockers as large as the light and larger, in five directions from it, their edges all over it.
fn discs() -> impl Iterator<Item = Disc> {
    const EDGES: usize = 16;
    [1.0, 3.0, 50.0].into_iter().flat_map(|radius| {
        (0..5 * EDGES).map(move |i| {
            // Directions that no symmetry of the square maps onto each other.
            let (sine, cosine) = (0.1 + 0.77 * (i / EDGES) as f32).sin_cos();
            let edge = 1.0 - 2.0 * ((i % EDGES) as f32 + 0.5) / EDGES as f32;
            Disc { center: [cosine, sine].map(|axis| axis * (radius + edge)), radius }
        })
    })
}

/// The fraction of a light's solid angle that a disc hides, on a fine grid.
fn exactly_hidden(square: &Square, disc: &Disc) -> f64 {
    const STEPS: i32 = 40;
    let (mut whole, mut hidden) = (0.0, 0.0);
    for i in 0..STEPS * STEPS {
        let [x, y] = [i % STEPS, i / STEPS].map(|step| (step as f32 + 0.5) / (STEPS / 2) as f32 - 1.0);
        if x.hypot(y) < 1.0 {
            let stretch = square.stretch(f32x8::splat(x), f32x8::splat(y)).to_array()[0];
            let weight = f64::from(stretch * stretch);
            whole += weight;
            if (x - disc.center[0]).hypot(y - disc.center[1]) < disc.radius {
                hidden += weight;
            }
        }
    }
    hidden / whole
}

/// Solution of a positive definite system, by elimination.
fn solve(mut matrix: [ByLevel; MAX_DEPTH + 1], mut right: ByLevel) -> ByLevel {
    for pivot in 0..=MAX_DEPTH {
        for row in pivot + 1..=MAX_DEPTH {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            let above = matrix[pivot];
            matrix[row].iter_mut().zip(above).for_each(|(value, above)| *value -= factor * above);
            right[row] -= factor * right[pivot];
        }
    }
    for pivot in (0..=MAX_DEPTH).rev() {
        right[pivot] /= matrix[pivot][pivot];
        for row in 0..pivot {
            right[row] -= matrix[row][pivot] * right[pivot];
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CosineLobe;
    use halfshade_strategy::Strategy;

    fn tables(settings: &str) -> (Settings, Cells, CapLobeTable, LobeTable) {
        let params = CosineLobe.info().parse(settings).unwrap();
        let settings = Settings::read(&params);
        let (cells, caps) = (Cells::new(settings.depth), CapLobeTable::build(settings.fit.into()));
        let products = LobeTable::build(settings.product.into());
        (settings, cells, caps, products)
    }

    #[test]
    fn weights_join_at_the_papers_distances_and_have_an_end() {
        for kind in ["umbra", "fitted", "solid-angle"] {
            let (settings, cells, caps, table) = tables(&format!("depth=4,weights={kind},leaves=aggressive"));
            let weights = WeightTable::new(&settings, &cells, &caps, &table);
            for distance in [0.1, 0.25, 1.0, 4.5, 10.0, 1e6, f32::INFINITY] {
                let by_level: Vec<f32> = (0..=4).map(|level| weights.at(level, distance)).collect();
                assert!(by_level.iter().all(|w| (0.3..4.0).contains(w)), "{kind} {distance}: {by_level:?}");
            }
            assert!((weights.at(2, 0.999_9) - weights.at(2, 1.000_1)).abs() < 1e-3);
        }
    }

    /// Over the discs that are fitted, and those of the umbra can't be better.
    #[test]
    fn fitted_weights_are_nearest_to_the_truth() {
        let (settings, cells, caps, table) = tables("depth=5,leaves=aggressive");
        let finding = Finding { settings: &settings, cells: &cells, caps: &caps, table: &table };
        let square = Square::new([0.0, 1.0, 0.0], 0.2).unwrap();
        let light = light_lobe(&square, &caps);
        let whole = f64::from(light.integral().to_array()[0]);
        let error = |weights: ByLevel| {
            let squares = discs().map(|disc| {
                let by_level = finding.hidden_by_level(&light, &square, &disc);
                let found: f64 = by_level.iter().zip(weights).map(|(hidden, weight)| hidden * weight).sum();
                (found / whole - exactly_hidden(&square, &disc)).powi(2)
            });
            (squares.sum::<f64>() / discs().count() as f64).sqrt()
        };
        let (umbra, fitted) = (error(finding.umbra(&square)), error(finding.fitted(&square)));
        assert!(fitted < 0.9 * umbra && fitted < 0.1, "{fitted} {umbra}");
    }

    #[test]
    fn elimination_solves() {
        let matrix: [ByLevel; MAX_DEPTH + 1] =
            from_fn(|i| from_fn(|j| if i == j { 3.0 } else { 1.0 / (1 + i + j) as f64 }));
        let expected: ByLevel = from_fn(|i| i as f64 - 2.0);
        let right = matrix.map(|row| row.iter().zip(expected).map(|(a, x)| a * x).sum());
        assert!(solve(matrix, right).iter().zip(expected).all(|(found, x)| (found - x).abs() < 1e-12));
    }
}
