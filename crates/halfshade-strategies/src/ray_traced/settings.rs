//! Everything that can be set.

use halfshade_strategy::{Stage, choice, settings};

choice! {
    /// How directions are drawn.
    pub(super) enum Sampling {
        /// by the cosine and other lobes of the receiver
        Cosine = "cosine",
        /// by the light's radiance
        Light = "light",
        /// half and half, weighted by the density of the mixture
        Both = "mis",
        /// by light times cosine, light by light [Clarberg2005]; of glossy receivers as `mis`
        Product = "product",
    }
}

choice! {
    /// Use of the rays of a receiver.
    pub enum Estimator {
        /// their light, unbiased: light and visibility are estimated together
        Plain = "plain",
        /// all of the light, which is known, times the share of it that the rays see [Heitz2018]
        Ratio = "ratio",
    }
}

choice! {
    /// Mean over neighbours.
    pub(super) enum Filter {
        /// each receiver by itself
        None = "none",
        /// shares of receivers that are alike, over steps that double [Dammertz2010]
        EdgeAvoiding = "edge-avoiding",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] =
    &[Stage { name: "filter", exact: "filter=none" }, Stage { name: "noise", exact: "samples=1024" }];

settings! {
    /// Everything that can be set.
    pub(super) struct Settings {
        /// rays per receiver
        "samples" => samples: u32 = 16, in 1..=4096, levels ["1", "2", "4", "8", "16", "32", "64"];
        /// how directions are drawn
        "sampling" => sampling: Sampling = Sampling::Product;
        /// what is made of them
        "estimator" => estimator: Estimator = Estimator::Ratio;
        /// what neighbours tell each other: pixels of a picture, vertices of a mesh
        "filter" => filter: Filter = Filter::EdgeAvoiding, levels ["none", "edge-avoiding"];
        /// times that a filter looks twice as far
        "filter-levels" => filter_levels: u32 = 3, in 1..=8;
        /// degrees between normals from which on neighbours tell each other nothing
        "filter-angle" => filter_angle: f32 = 30.0, in 1.0..=90.0;
        /// standard deviations between shares from which on they don't
        "filter-deviations" => filter_deviations: f32 = 4.0, in 0.0..=1000.0;
    }
}

impl Sampling {
    /// Share of directions drawn by cosine, or by the lobes of a glossy receiver.
    pub(super) const fn cosine_share(self) -> f64 {
        match self {
            Self::Cosine => 1.0,
            Self::Light => 0.0,
            Self::Both | Self::Product => 0.5,
        }
    }
}
