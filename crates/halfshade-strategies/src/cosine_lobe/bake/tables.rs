//! Tables that depend on settings alone.

use super::{cells::Cells, weights::WeightTable};
use crate::cosine_lobe::{
    kernel::sampled::Sampler,
    settings::{Integration, Order, Settings},
};
use halfshade_scene::once;
use halfshade_sh::lobe::{CapLobeTable, LobeTable, ProductRule};
use std::sync::OnceLock;

/// Tables that depend on settings alone.
#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) products: &'static LobeTable,
    pub(crate) caps: CapLobeTable,
    pub(crate) cells: Cells,
    pub(crate) weights: WeightTable,
    /// In place of products.
    pub(crate) sampler: Option<Sampler>,
}

impl Tables {
    pub(crate) fn new(settings: &Settings) -> Self {
        let products = products_of(settings.product.into());
        let caps = CapLobeTable::build(settings.fit.into());
        let cells = Cells::new(settings.depth);
        let sampler = match settings.integration {
            Integration::Analytic => None,
            Integration::Sampled => Some(Sampler::new(settings.samples)),
        };
        let weights = match settings.order {
            Order::LightFirst => WeightTable::ones(),
            Order::Published => WeightTable::new(settings, &cells, &caps, products),
        };
        Self { products, caps, cells, weights, sampler }
    }
}

/// The table of a rule, kept for all scenes.
fn products_of(rule: ProductRule) -> &'static LobeTable {
    static TABLES: [OnceLock<LobeTable>; ProductRule::ALL.len()] = [const { OnceLock::new() }; ProductRule::ALL.len()];
    once(&TABLES[rule as usize], || LobeTable::build(rule))
}
