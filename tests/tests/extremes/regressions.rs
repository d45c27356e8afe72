//! Scenes that failed once.

/// Seed, strategy with its settings, and what was wrong.
pub(crate) const ALL: &[(u64, &str, &str)] = &[
    (
        16,
        "cosine-lobe:depth=0,leaves=fraction,integration=sampled,samples=49,env-lamps=8,env-lobes=7,env-depth=3",
        "light times a power of two changed what was fitted to it",
    ),
    (
        21,
        "shadow-field:sampling=traced,shells=1,resolution=1,map=8,bands=4,storage=f32",
        "products of few bands left what they can be",
    ),
];
