//! Everything that can be set.

use halfshade_strategy::{choice, settings};

choice! {
    /// The light that transfer vectors know of.
    pub(crate) enum TransferKind {
        /// from infinitely far, hidden by nothing
        Unshadowed = "unshadowed",
        /// from infinitely far, hidden by all objects
        Shadowed = "shadowed",
        /// the same, and what surfaces reflect, as many bounces as the scene asks for
        Interreflected = "interreflected",
    }
}

settings! {
    /// Everything that can be set.
    pub(crate) struct Settings {
        /// bands of light and transfer
        "bands" => bands: usize = 4, in 1..=8;
        /// light that transfer vectors know of
        "transfer" => transfer: TransferKind = TransferKind::Interreflected;
        /// rays from each vertex when transfer is baked
        "directions" => directions: usize = 1024, in 16..=65_536;
    }
}
