//! Tables that depend on no frame.

use super::{sampled::Sampler, square::Cells, weights::WeightTable};
use halfshade_sh::lobe::{CapLobeTable, LobeTable};

/// What depends on no frame.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) products: &'static LobeTable,
    pub(super) caps: CapLobeTable,
    pub(super) cells: Cells,
    pub(super) weights: WeightTable,
    /// In place of products.
    pub(super) sampler: Option<Sampler>,
}
