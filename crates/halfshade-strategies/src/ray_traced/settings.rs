//! Everything that can be set.

use halfshade_strategy::{choice, settings};

choice! {
    /// How directions are drawn.
    pub(super) enum Sampling {
        /// by the cosine and other lobes of the receiver
        Cosine = "cosine",
        /// by the light's radiance
        Light = "light",
        /// half and half, weighted by the density of the mixture
        Both = "mis",
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

settings! {
    /// Everything that can be set.
    pub(super) struct Settings {
        /// rays per receiver
        "samples" => samples: u32 = 16, in 1..=4096;
        /// how directions are drawn
        "sampling" => sampling: Sampling = Sampling::Both;
        /// what is made of them
        "estimator" => estimator: Estimator = Estimator::Plain;
    }
}

impl Sampling {
    /// Share of directions drawn by cosine, or by the lobes of a glossy receiver.
    pub(super) const fn cosine_share(self) -> f64 {
        match self {
            Self::Cosine => 1.0,
            Self::Light => 0.0,
            Self::Both => 0.5,
        }
    }
}
