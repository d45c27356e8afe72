//! What can be set.

use super::mask::MAX_DEPTH;
use halfshade_scene::spheres::AdjustRule;
use halfshade_sh::lobe::{CapFit, ProductRule};
use halfshade_strategy::{Parameter, ParameterKind, Params};
use std::hint::black_box;

/// Which two of reflectance, light and visibility are multiplied first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Light and visibility, exactly: the leaves are parts of the light.
    LightFirst,
    /// Reflectance and light, as lobes [Meunier2009, 5.4].
    Published,
}

/// What becomes of cells that no sphere covers wholly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Leaves {
    /// Ignored.
    Aggressive,
    /// Kept as if they were covered.
    Conservative,
    /// Kept by the fraction that is covered.
    Fraction,
}

/// How lobes that overlap are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weights {
    /// By least squares, so that what one blocker hides of a light is nearest to the truth.
    Fitted,
    /// So that a level's leaves together hide the whole light.
    Umbra,
    /// Not: lobes have the solid angle of their leaves.
    SolidAngle,
}

/// A part of the work for one receiver and light, in the order of [Meunier2009, table 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// Lobes of the reflectance.
    Reflectance,
    /// The light, and what of it is reflected unblocked.
    Light,
    /// Spheres in the way, and which cells they cover.
    Mask,
    /// Lobes of the covered cells.
    MaskLobes,
    /// Integrals of their products.
    Integrals,
}

/// All parameters, read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    pub(super) order: Order,
    pub(super) depth: usize,
    pub(super) leaves: Leaves,
    pub(super) weights: Weights,
    pub(super) fit: CapFit,
    pub(super) product: ProductRule,
    /// Directions per integral, instead of products.
    pub(super) samples: Option<usize>,
    /// Done twice, so that a clock tells its share.
    pub(super) twice: Option<Stage>,
    pub(super) rule: AdjustRule,
    pub(super) threshold: f32,
    pub(super) share: f32,
    pub(super) environment_lamps: usize,
    pub(super) environment_lobes: usize,
    pub(super) environment_depth: usize,
}

pub(super) fn all() -> Vec<Parameter> {
    let choice =
        |name, summary, values, default| Parameter { name, summary, kind: ParameterKind::Choice { values, default } };
    let integer = |name, summary, default, [min, max]: [i64; 2]| Parameter {
        name,
        summary,
        kind: ParameterKind::Integer { default, min, max },
    };
    let part = |name, summary, default| Parameter {
        name,
        summary,
        kind: ParameterKind::Float { default, min: 0.0, max: 1.0 },
    };
    vec![
        choice(
            "order",
            "what is multiplied first: light and mask, exactly; or, published, reflectance and light as lobes",
            &["light-first", "published"],
            "light-first",
        ),
        integer(
            "depth",
            "levels of the mask's quad-tree below its root; 0 is the root alone",
            5,
            [0, MAX_DEPTH as i64],
        ),
        choice(
            "leaves",
            "partly covered cells of the last level: ignored, kept, or kept by the fraction covered (not published)",
            &["aggressive", "conservative", "fraction"],
            "fraction",
        ),
        choice(
            "weights",
            "for order=published: fitted to the truth; a level's leaves hide the whole light; lobes of the leaves' solid angles",
            &["fitted", "umbra", "solid-angle"],
            "fitted",
        ),
        choice(
            "fit",
            "for order=published: lobes for lights and bounding spheres",
            &["least-squares", "least-squares-scaled", "solid-angle", "scaled-solid-angle"],
            "scaled-solid-angle",
        ),
        choice(
            "product",
            "how a product of two lobes becomes a lobe",
            &["published", "integral-preserving", "moments"],
            "moments",
        ),
        choice(
            "integration",
            "sums of lobes by products, or for comparison by sampling the lobes",
            &["analytic", "sampled"],
            "analytic",
        ),
        integer("samples", "for integration=sampled: directions per integral", 64, [1, 65_536]),
        choice(
            "twice",
            "a part of the work that is done twice: by how much that takes longer is its share of the time",
            &["nothing", "reflectance", "light", "mask", "mask-lobes", "integrals"],
            "nothing",
        ),
        choice(
            "rule",
            "spheres that cut the tangent plane: see sh-exp",
            &["continuous", "covering", "published"],
            "continuous",
        ),
        part(
            "threshold",
            "products below this fraction of the unblocked light's are left out; 0 leaves out none",
            1e-4,
        ),
        part(
            "share",
            "side of the cubes of space whose receivers share masks, in radii of the light, or in diameters of a ball around all spheres if that is less; 0 shares none",
            0.0,
        ),
        integer(
            "env-lamps",
            "small bright parts of an environment map that become lights of their own, at most",
            2,
            [0, 8],
        ),
        integer("env-lobes", "lobes fitted to an environment map, beside a constant", 16, [0, 64]),
        integer("env-depth", "cells along each side of a hemisphere that blockers cover, as a power of 2", 5, [3, 6]),
    ]
}

impl Settings {
    pub(super) fn new(params: &Params) -> Self {
        Self {
            order: if params.choice("order") == "published" { Order::Published } else { Order::LightFirst },
            depth: params.integer("depth") as usize,
            leaves: match params.choice("leaves") {
                "aggressive" => Leaves::Aggressive,
                "conservative" => Leaves::Conservative,
                _ => Leaves::Fraction,
            },
            weights: match params.choice("weights") {
                "umbra" => Weights::Umbra,
                "solid-angle" => Weights::SolidAngle,
                _ => Weights::Fitted,
            },
            fit: match params.choice("fit") {
                "least-squares" => CapFit::LeastSquares,
                "least-squares-scaled" => CapFit::LeastSquaresScaled,
                "solid-angle" => CapFit::SolidAngle,
                _ => CapFit::ScaledSolidAngle,
            },
            product: match params.choice("product") {
                "published" => ProductRule::Published,
                "integral-preserving" => ProductRule::IntegralPreserving,
                _ => ProductRule::Moments,
            },
            samples: (params.choice("integration") == "sampled").then(|| params.integer("samples") as usize),
            twice: match params.choice("twice") {
                "reflectance" => Some(Stage::Reflectance),
                "light" => Some(Stage::Light),
                "mask" => Some(Stage::Mask),
                "mask-lobes" => Some(Stage::MaskLobes),
                "integrals" => Some(Stage::Integrals),
                _ => None,
            },
            rule: match params.choice("rule") {
                "covering" => AdjustRule::Covering,
                "published" => AdjustRule::Published,
                _ => AdjustRule::Continuous,
            },
            threshold: params.float("threshold") as f32,
            share: params.float("share") as f32,
            environment_lamps: params.integer("env-lamps") as usize,
            environment_lobes: params.integer("env-lobes") as usize,
            environment_depth: params.integer("env-depth") as usize,
        }
    }

    /// One stage of the work, as often as is asked for. What it leaves is the same.
    #[inline(always)]
    pub(super) fn stage<T>(&self, stage: Stage, mut work: impl FnMut() -> T) -> T {
        if self.twice == Some(stage) {
            black_box(work());
        }
        work()
    }
}
