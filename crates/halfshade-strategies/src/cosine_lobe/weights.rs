//! Weights against the overlap of neighbouring lobes [Meunier2009, 5.3, eq. 39].
//!
//! Lobes of bounding spheres overlap, the more so the larger the light, and the light's lobe reaches past its cone. The paper
//! sets w by eye, per level and distance of the square: full darkness in the umbra first, then each level so that it joins the
//! one before. Both mean that a level's leaves, all in shadow, hide the whole light, which is a formula:
//!
//! ```text
//! w(level, dist) = ∫ c_light / Σ_i ∫ c_light c_i       over the level's cells that have light
//! ```
//!
//! It is evaluated at the paper's distances when tables are built, and linear in between.

use super::{
    lobes::{CellLobes, Shape},
    parameters::Weights,
    square::{Cells, Square},
};
use halfshade_sh::{
    kernel::CapBatch,
    lobe::{CapTable, Lobe8, LobeTable},
};
use wide::f32x8;

/// `dist` of [Meunier2009, 5.3].
const DISTANCES: [f32; 12] = [0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];

/// w by distance and level.
#[derive(Debug, Clone)]
pub(super) struct WeightTable(Vec<Vec<f32>>);

impl WeightTable {
    pub(super) fn new(kind: Weights, depth: usize, cells: &Cells, caps: &CapTable, table: &LobeTable) -> Self {
        let at = |distance: f32, level: usize| match kind {
            Weights::SolidAngle => 1.0,
            Weights::Umbra => {
                // tan σ = 1/(2 dist), of a light at distance 1.
                let sine = (1.0 + 4.0 * distance * distance).sqrt().recip();
                let Some(square) = Square::new([0.0, 1.0, 0.0], sine) else { return 1.0 };
                let light = light_lobe(&square, caps);
                let mut lobes = CellLobes::default();
                let shape = Shape::Bounding(caps);
                cells.level(level).for_each(|&cell| lobes.push(cell, level, 1.0, &square, shape));
                lobes.flush(&square, shape);
                let hidden = lobes.integral(&light, table, None, &mut [0; 2]);
                light.integral().to_array()[0] / hidden.max(f32::MIN_POSITIVE)
            }
        };
        Self(DISTANCES.iter().map(|&distance| (0..=depth).map(|level| at(distance, level)).collect()).collect())
    }

    /// Linear in the distance, constant beyond the table.
    pub(super) fn at(&self, level: usize, distance: f32) -> f32 {
        let above = DISTANCES.partition_point(|&known| known <= distance).clamp(1, DISTANCES.len() - 1);
        let (low, high) = (DISTANCES[above - 1], DISTANCES[above]);
        let part = ((distance - low) / (high - low)).clamp(0.0, 1.0);
        (1.0 - part) * self.0[above - 1][level] + part * self.0[above][level]
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.iter().map(|levels| size_of_val(levels.as_slice())).sum()
    }
}

/// The light as one lobe in every lane [Meunier2009, eq. 31], radiance apart.
pub(super) fn light_lobe(square: &Square, caps: &CapTable) -> Lobe8 {
    let direction = square.axis().map(f32x8::splat);
    caps.lookup(&CapBatch { direction, versine: f32x8::splat(square.versine()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_sh::lobe::{CapFit, ProductRule};

    #[test]
    fn weights_fall_as_lobes_overlap_more_and_join_at_the_papers_distances() {
        let (caps, table) = (CapTable::build(CapFit::LeastSquares), LobeTable::build(ProductRule::Moments));
        let cells = Cells::new(4);
        let weights = WeightTable::new(Weights::Umbra, 4, &cells, &caps, &table);
        for distance in [0.1, 0.25, 1.0, 4.5, 10.0, 1e6] {
            let by_level: Vec<f32> = (0..=4).map(|level| weights.at(level, distance)).collect();
            assert!(by_level.iter().all(|w| (0.3..4.0).contains(w)), "{distance}: {by_level:?}");
        }
        let jump = weights.at(2, 0.999_9) - weights.at(2, 1.000_1);
        assert!(jump.abs() < 1e-3);
        assert_eq!(WeightTable::new(Weights::SolidAngle, 4, &cells, &caps, &table).at(3, 2.5), 1.0);
    }
}
