//! Kernels of precomputed radiance transfer.

use super::twin::{EYE_LOBES, Kernel, LIGHT_CAP, NEAR_ZERO, RECEIVERS, REFLECTANCE, Twin};

const TRANSFER_DOT: Twin = Twin {
    shader: "prt/dot.wgsl",
    cpu: "halfshade_strategies::prt::kernel::dot",
    tolerance: 1e-6,
    reason: "sums in another order",
};

const TRANSFER_LOBE: Twin = Twin {
    shader: "prt/lobe.wgsl",
    cpu: "halfshade_strategies::prt::kernel::lobe",
    tolerance: 2e-5,
    reason: "factors of a fit are up to a hundred times what they add up to",
};

const TRANSFER_GLOSS: Twin = Twin {
    shader: "prt/gloss.wgsl",
    cpu: "halfshade_strategies::prt::shade::gloss",
    tolerance: 1e-4,
    reason: "that of the reflectance",
};

/// Transfer times light.
pub const PRT: Kernel = Kernel {
    name: "prt",
    shader: "prt/shade.wgsl",
    twins: &[REFLECTANCE, EYE_LOBES, NEAR_ZERO, TRANSFER_DOT, TRANSFER_LOBE, TRANSFER_GLOSS],
    buffers: &[RECEIVERS, &["frame", "rows", "points"]],
};

/// Transfer times light of every receiver's own.
pub const PRT_LAMPS: Kernel = Kernel {
    name: "prt-lamps",
    shader: "prt/shade_lamps.wgsl",
    twins: &[
        REFLECTANCE,
        EYE_LOBES,
        NEAR_ZERO,
        TRANSFER_DOT,
        TRANSFER_LOBE,
        TRANSFER_GLOSS,
        LIGHT_CAP,
        Twin {
            shader: "prt/lamps.wgsl",
            cpu: "halfshade_strategies::prt::kernel::lamps",
            tolerance: 2e-5,
            reason: "that of the caps",
        },
    ],
    buffers: &[RECEIVERS, &["frame", "rows", "points", "lamps"]],
};

/// Compressed transfer times light.
pub const PRT_CLUSTERS: Kernel = Kernel {
    name: "prt-clusters",
    shader: "prt/shade_clusters.wgsl",
    twins: &[Twin {
        shader: "prt/decode.wgsl",
        cpu: "halfshade_strategies::prt::kernel::decode",
        tolerance: 1e-6,
        reason: "sums in another order",
    }],
    buffers: &[RECEIVERS, &["frame", "row_weights", "points", "products"]],
};
