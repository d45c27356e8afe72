//! Everything that can be set.

use crate::shared::adjustment::Rule;
use halfshade_strategy::{Preset, Stage, choice, settings};

choice! {
    /// Use of an object's own mesh for the receivers on it.
    pub(crate) enum Own {
        /// directions that the mesh itself hides, baked per vertex; its spheres are left out
        Baked = "baked",
        /// its spheres, as for receivers on other objects
        Spheres = "spheres",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "own cells", exact: "own-cells=64" },
    Stage { name: "normals", exact: "normals=8" },
    Stage { name: "directions", exact: "directions=1024" },
];

settings! {
    /// Everything that can be set.
    pub(crate) struct Settings {
        /// directions that each receiver looks into: as many of the sky, as many shared by all lamps, half as many along each
        /// glossy lobe
        "directions" => directions: usize = 64, in 8..=1024, levels ["16", "32", "64", "128", "256", "512"];
        /// cells of the grid of normals that have directions of their own, from its centre to its side; 0: one set for all
        "normals" => normals: usize = 3, in 0..=8;
        /// width over which a sphere's edge closes a direction, in radii of the direction's cell; 0: it is open or closed
        "edge" => edge: f32 = 1.0, in 0.0..=2.0;
        /// hiding of light by a receiver's own object
        "own" => own: Own = Own::Baked;
        /// for own=baked: cells along the side of the octahedral grid of directions
        "own-cells" => own_cells: usize = 24, in 4..=64;
        /// small bright parts of an environment map that become lamps, at most
        "env-lamps" => environment_lamps: usize = 2, in 0..=8;
        /// spheres that cut the tangent plane
        "rule" => rule: Rule = Rule::Continuous;
    }
}

/// Values under one name.
pub(crate) const PRESETS: &[Preset] = &[
    Preset { name: "bits", summary: "directions that are open or closed: a mask of bits", settings: "edge=0" },
    Preset { name: "fine", summary: "four times as many directions", settings: "directions=256" },
];
