//! Everything that can be set.

use super::bake::{basis::Storage, field::Thinning, meshes::Source, projected::ShellLayout};
use halfshade_strategy::{Preset, Stage, choice, settings};
use serde::{Deserialize, Serialize};

choice! {
    /// The basis in which fields are kept.
    pub(crate) enum Basis {
        /// spherical harmonics
        Sh = "sh",
        /// Haar wavelets on the faces of a cube
        Haar = "haar",
    }
}

choice! {
    /// Sample points within a solid.
    pub(crate) enum Inside {
        /// moved to the nearest places outside
        Moved = "moved",
        /// blocked, as published
        Blocked = "blocked",
    }
}

choice! {
    /// How densely fields are sampled.
    pub(crate) enum Sampling {
        /// shells as dense as the threshold asks for
        Adaptive = "adaptive",
        /// only those shells that the threshold asks for
        AdaptiveShells = "adaptive-shells",
        /// all at the full resolution
        Fixed = "fixed",
        /// no fields but rays at the receiver, for each object
        Traced = "traced",
        /// rays at the receiver for all objects together: no products either
        Together = "together",
    }
}

choice! {
    /// How an object's own occlusion meets the cosine.
    pub(crate) enum OwnOcclusion {
        /// projected together
        Projected = "projected",
        /// multiplied, as an SH product [Tamura2006, figure 3]
        Product = "product",
    }
}

choice! {
    /// How a row of wavelets tells which coefficients it has.
    #[derive(Serialize, Deserialize)]
    pub(crate) enum Coding {
        /// listed by number, as published
        Listed = "listed",
        /// as trees, where parents tell of their children
        Tree = "tree",
    }
}

choice! {
    /// How visibilities are multiplied.
    pub(crate) enum Product {
        /// texel by texel
        Texels = "texels",
        /// as the triple product of wavelets
        Wavelets = "wavelets",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "storage", exact: "storage=f32" },
    Stage { name: "interpolation", exact: "sampling=traced" },
    Stage { name: "products", exact: "sampling=together" },
    Stage { name: "bands", exact: "bands=8" },
];

settings! {
    /// All parameters.
    pub(crate) struct Settings {
        /// basis of fields
        "basis" => basis: Basis = Basis::Sh;
        /// SH: bands of visibility
        "bands" => bands: usize = 4, in 1..=8, levels ["2", "3", "4", "5", "6"];
        /// concentric shells
        "shells" => shells: usize = 32, in 1..=128;
        /// shells within the first, each half as large as the next; 0 as published
        "inner" => inner: u32 = 3, in 0..=8;
        /// distance between shells, in radii of their object
        "spacing" => spacing: f32 = 0.2, in 0.01..=2.0;
        /// sample points per shell, in longitude as in latitude; rounded up to a power of two
        "resolution" => resolution: usize = 64, in 1..=256;
        /// sample points within a solid
        "inside" => inside: Inside = Inside::Moved;
        /// SH: directions per sample point, in longitude as in latitude
        "map" => map: usize = 64, in 8..=256;
        /// how densely fields are sampled
        "sampling" => sampling: Sampling = Sampling::Adaptive;
        /// adaptive: mean absolute error of visibility, over all directions, that a sample point may have
        "threshold" => threshold: f64 = 0.010, in 0.0..=1.0;
        /// how coefficients are stored
        "storage" => storage: Storage = Storage::U8;
        /// SH: an object's own occlusion times the cosine
        "own" => own: OwnOcclusion = OwnOcclusion::Product;
        /// Haar: texels along the edges of a cube's face; rounded up to a power of two
        "face" => face: usize = 32, in 1..=64;
        /// Haar: share of coefficients that a sample point keeps, the largest
        "kept" => kept: f64 = 0.05, in 0.0..=1.0;
        /// Haar: how rows of coefficients are stored
        "coding" => coding: Coding = Coding::Tree;
        /// Haar: how visibilities are multiplied
        "product" => product: Product = Product::Texels;
    }
}

/// Values under one name.
pub(crate) const PRESETS: &[Preset] = &[Preset {
    name: "as-published",
    summary: "[Tamura2006]: no shells within the first, sample points within solids blocked, wavelets listed and multiplied as such",
    settings: "inner=0,inside=blocked,coding=listed,product=wavelets",
}];

impl Settings {
    /// The sample points of a field.
    pub(crate) fn shell_layout(&self) -> ShellLayout {
        ShellLayout {
            count: self.shells,
            inner: self.inner,
            resolution: self.resolution.next_power_of_two(),
            spacing: self.spacing,
            leaves_solids: self.inside == Inside::Moved,
        }
    }

    /// How fields are thinned out.
    pub(crate) fn thinning(&self) -> Thinning {
        Thinning {
            threshold: (self.sampling != Sampling::Fixed).then_some(self.threshold),
            drops_shells: self.sampling == Sampling::AdaptiveShells,
        }
    }

    /// Where visibility comes from.
    pub(crate) fn source(&self) -> Source {
        match self.sampling {
            Sampling::Adaptive | Sampling::AdaptiveShells | Sampling::Fixed => Source::Fields,
            Sampling::Traced => Source::Traced,
            Sampling::Together => Source::Together,
        }
    }
}
