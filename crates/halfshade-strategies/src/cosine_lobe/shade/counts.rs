//! Numbers of products and masks, for the details of a strategy.

use halfshade_strategy::Detail;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Numbers of one call.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    /// Products found and left out.
    pub(crate) products: [u64; 2],
    /// Pairs of receiver and light whose mask was built, and lobes of those masks.
    pub(crate) masks: u64,
    pub(crate) lobes: u64,
}

/// Numbers since baking.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    products: AtomicU64,
    left_out: AtomicU64,
    masks: AtomicU64,
    lobes: AtomicU64,
}

impl Counters {
    pub(crate) fn add(&self, counts: &Counts) {
        self.products.fetch_add(counts.products[0], Relaxed);
        self.left_out.fetch_add(counts.products[1], Relaxed);
        self.masks.fetch_add(counts.masks, Relaxed);
        self.lobes.fetch_add(counts.lobes, Relaxed);
    }

    pub(crate) fn details(&self) -> Vec<Detail> {
        let Self { products, left_out, masks, lobes } = self;
        let detail =
            |name: &str, count: &AtomicU64| Detail { name: name.into(), values: vec![count.load(Relaxed) as f64] };
        vec![
            detail("lobe products since baking", products),
            detail("lobe products left out since baking", left_out),
            detail("visibility masks since baking", masks),
            detail("visibility lobes since baking", lobes),
        ]
    }
}
