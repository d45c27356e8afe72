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

choice! {
    /// How transfer vectors are stored.
    pub(crate) enum Compression {
        /// as they are
        None = "none",
        /// by principal components of all of them
        Pca = "pca",
        /// by clusters of vectors that are taken as equal
        Vq = "vq",
        /// by principal components of each of several clusters
        Cpca = "cpca",
    }
}

choice! {
    /// Objects that move against the others, or deform.
    pub(crate) enum Moving {
        /// scenes with any are refused
        Refuse = "refuse",
        /// they receive light from a volume of what arrives among the others, and hide none
        Volume = "volume",
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
        /// how transfer vectors are stored
        "compression" => compression: Compression = Compression::None;
        /// clusters of vectors, for `vq` and `cpca`
        "clusters" => clusters: usize = 256, in 1..=4096;
        /// principal components of each cluster, for `pca` and `cpca`
        "components" => components: usize = 8, in 0..=192;
        /// what becomes of objects that move against the others
        "moving" => moving: Moving = Moving::Refuse;
        /// steps of the volume along its longest side
        "volume-steps" => volume_steps: usize = 12, in 1..=64;
    }
}
