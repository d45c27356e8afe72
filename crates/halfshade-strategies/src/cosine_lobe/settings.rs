//! Everything that can be set.

use super::kernel::mask::MAX_DEPTH;
use crate::shared::adjustment::Rule;
use halfshade_sh::lobe::{CapFit, ProductRule};
use halfshade_strategy::{Preset, Stage, choice, settings};

choice! {
    /// Which two of reflectance, light and visibility are multiplied first.
    pub(crate) enum Order {
        /// light and visibility, exactly: the leaves are parts of the light
        LightFirst = "light-first",
        /// reflectance and light, as lobes [Meunier2009, 5.4]
        Published = "published",
    }
}

choice! {
    /// Cells of the last level that no sphere covers wholly.
    pub(crate) enum Leaves {
        /// ignored
        Aggressive = "aggressive",
        /// kept as if they were covered
        Conservative = "conservative",
        /// kept by the fraction that is covered
        Fraction = "fraction",
    }
}

choice! {
    /// How lobes that overlap are weighted.
    pub(crate) enum Weights {
        /// by least squares, so that what one blocker hides of a light is nearest to the truth
        Fitted = "fitted",
        /// so that a level's leaves together hide the whole light
        Umbra = "umbra",
        /// not: lobes have the solid angle of their leaves
        SolidAngle = "solid-angle",
    }
}

choice! {
    /// The lobe for a light or a bounding sphere.
    pub(crate) enum Fit for CapFit {
        /// scale 1, exponent by least squares [Meunier2009, eq. 31-34]
        LeastSquares = "least-squares",
        /// exponent and scale by least squares
        LeastSquaresScaled = "least-squares-scaled",
        /// scale 1, exponent by solid angle
        SolidAngle = "solid-angle",
        /// exponent by least squares, scale by solid angle
        ScaledSolidAngle = "scaled-solid-angle",
    }
}

choice! {
    /// How a product of two lobes becomes a lobe.
    pub(crate) enum Product for ProductRule {
        /// axis at the peak, exponent and scale by least squares [Meunier2009, eq. 15-19]
        Published = "published",
        /// axis and exponent as published, scale by the integral
        IntegralPreserving = "integral-preserving",
        /// by the product's integral and mean vector
        Moments = "moments",
    }
}

choice! {
    /// How sums of lobes are integrated.
    pub(crate) enum Integration {
        /// by products
        Analytic = "analytic",
        /// by sampling the lobes, for comparison
        Sampled = "sampled",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "sharing", exact: "share=0" },
    Stage { name: "threshold", exact: "threshold=0" },
    Stage { name: "depth of the mask", exact: "depth=6,env-depth=6" },
    Stage { name: "lobes of the light", exact: "env-lobes=64" },
    Stage { name: "products of lobes", exact: "integration=sampled,samples=4096" },
];

settings! {
    /// All parameters.
    pub(crate) struct Settings {
        /// what is multiplied first
        "order" => order: Order = Order::LightFirst;
        /// levels of the mask's quad-tree below its root; 0 is the root alone
        "depth" => depth: usize = 5, in 0..=MAX_DEPTH, levels ["3", "4", "5", "6"];
        /// partly covered cells of the last level
        "leaves" => leaves: Leaves = Leaves::Fraction;
        /// for order=published: how lobes that overlap are weighted
        "weights" => weights: Weights = Weights::Fitted;
        /// for order=published: lobes for lights and bounding spheres
        "fit" => fit: Fit = Fit::ScaledSolidAngle;
        /// how a product of two lobes becomes a lobe
        "product" => product: Product = Product::Moments;
        /// how sums of lobes are integrated
        "integration" => integration: Integration = Integration::Analytic;
        /// for integration=sampled: directions per integral
        "samples" => samples: usize = 64, in 1..=65_536;
        /// spheres that cut the tangent plane
        "rule" => rule: Rule = Rule::Continuous;
        /// products below this fraction of the unblocked light's are left out; 0 leaves out none
        "threshold" => threshold: f32 = 1e-4, in 0.0..=1.0;
        /// side of the cubes of space whose receivers share masks, in radii of the light, or in diameters of a ball around
        /// all spheres if that is less; 0 shares none
        "share" => share: f32 = 0.0, in 0.0..=1.0;
        /// small bright parts of an environment map that become lights of their own, at most
        "env-lamps" => environment_lamps: usize = 2, in 0..=8;
        /// lobes fitted to an environment map, beside a constant
        "env-lobes" => environment_lobes: usize = 16, in 0..=64, levels ["4", "8", "16", "32"];
        /// cells along each side of a hemisphere that blockers cover, as a power of 2
        "env-depth" => environment_depth: usize = 5, in 3..=6;
    }
}

/// Values under one name.
pub(crate) const PRESETS: &[Preset] = &[Preset {
    name: "as-published",
    summary: "[Meunier2009]: reflectance times light first, partly covered leaves ignored, lobes and products by least squares",
    settings: "order=published,leaves=aggressive,fit=least-squares,product=published",
}];
