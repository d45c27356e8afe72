//! Everything that can be set.

use halfshade_scene::scene::MAX_BOUNCES;
use halfshade_sh::logarithm;
use halfshade_strategy::{Parameter, ParameterKind};

/// All parameters: of shadows, of the sphere hierarchy, of reflections.
pub(super) fn all() -> Vec<Parameter> {
    let parameter = |name, summary, kind| Parameter { name, summary, kind };
    let choice = |values, default| ParameterKind::Choice { values, default };
    vec![
        parameter(
            "exp",
            "how blockers combine: product, one after another; the exponential of summed logarithms; exposed shares; or \
             traced and projected, which no other way can beat",
            choice(&["product", "series", "optimal-linear", "hybrid", "quadratic", "shares", "traced"], "hybrid"),
        ),
        parameter("bands", "bands of visibility", ParameterKind::Integer { default: 4, min: 1, max: 8 }),
        parameter(
            "magnitude-limit",
            "hybrid, quadratic, series: magnitude at which squaring starts; 0: 8/bands² for the hybrid, else 1",
            ParameterKind::Float { default: 0.0, min: 0.0, max: 100.0 },
        ),
        parameter(
            "squaring",
            "one squaring more at each power of two of the limit: as published, or blended to be continuous",
            choice(&["continuous", "published"], "continuous"),
        ),
        parameter(
            "points",
            "shares: points per sphere that ask how many others cover them",
            ParameterKind::Integer { default: 8, min: 1, max: 64 },
        ),
        parameter(
            "directions",
            "traced: directions in which the nearest sphere is looked for",
            ParameterKind::Integer { default: 2048, min: 64, max: 65_536 },
        ),
        parameter("terms", "series: highest power", ParameterKind::Integer { default: 9, min: 1, max: 16 }),
        parameter(
            "scaling",
            "series: whether to scale and square as the hybrid does; it diverges for many blockers if not",
            choice(&["off", "on"], "on"),
        ),
        parameter("window", "against ringing", choice(&["none", "hann", "lanczos"], "none")),
        parameter(
            "clip",
            "smallest eigenvalue that the logarithm takes",
            ParameterKind::Float { default: logarithm::DEFAULT_CLIP, min: 1e-6, max: 0.5 },
        ),
        parameter(
            "rule",
            "spheres that cut the tangent plane: as published, continuous, or covering what is under them",
            choice(&["continuous", "covering", "published"], "continuous"),
        ),
        parameter(
            "overlap",
            "spheres of one object that cover each other: count each in full, or by its share of the silhouette",
            choice(&["independent", "shared"], "independent"),
        ),
        parameter(
            "levels",
            "spheres of the hierarchy: its leaves, per receiver cluster one level of each object, or a cut through the tree",
            choice(&["leaves", "cluster", "tree"], "leaves"),
        ),
        parameter(
            "branching",
            "children per parent in the hierarchy",
            ParameterKind::Integer { default: 4, min: 2, max: 16 },
        ),
        parameter(
            "cut-angle",
            "largest angular radius, in degrees, of a sphere that stands for finer ones",
            ParameterKind::Float { default: 15.0, min: 0.0, max: 90.0 },
        ),
        parameter(
            "ratios",
            "scale coarse spheres to what finer ones give at the cluster's centre: in shadows alone, or \
             also what they reflect, by eq. 4.34 upside down or as printed",
            choice(&["shadows", "on", "off", "printed"], "shadows"),
        ),
        parameter(
            "bounces",
            "most diffuse bounces, if the scene asks for more; 0: shadows alone",
            ParameterKind::Integer { default: MAX_BOUNCES as i64, min: 0, max: MAX_BOUNCES as i64 },
        ),
        parameter(
            "reflection-exp",
            "reflections: the exponential of the summed logarithms",
            choice(&["series", "optimal-linear", "hybrid", "quadratic"], "hybrid"),
        ),
        parameter(
            "reflection-limit",
            "reflections: magnitude at which squaring starts; 0: as for shadows",
            ParameterKind::Float { default: 4.8, min: 0.0, max: 100.0 },
        ),
        parameter(
            "intersections",
            "reflections: covering between intersecting spheres baked into their colours, or found by order",
            choice(&["precomputed", "ordered"], "ordered"),
        ),
        parameter(
            "order",
            "reflections: nearer is by the distance of centres, or by power distance",
            choice(&["center", "power"], "center"),
        ),
        parameter(
            "walk",
            "reflections: sums over nearer spheres one by one, or from a running sum",
            choice(&["linear", "quadratic"], "linear"),
        ),
        parameter(
            "projection",
            "reflections: light times colours as an SH product, or projected directly",
            choice(&["direct", "product"], "direct"),
        ),
        parameter(
            "radiance-bands",
            "reflections: bands of what each sphere radiates, at most those of visibility; 0: as many",
            ParameterKind::Integer { default: 0, min: 0, max: 8 },
        ),
        parameter(
            "form-factor",
            "reflections: average over a sphere weighted by the surface's cosine, or by solid angle",
            choice(&["cosine", "solid-angle"], "solid-angle"),
        ),
        parameter(
            "sample-divisions",
            "reflections: 10n² + 2 sample points around each sphere",
            ParameterKind::Integer { default: 2, min: 1, max: 6 },
        ),
        parameter(
            "ground",
            "objects without spheres: ignored by all others, or seen by them, to block and to reflect",
            choice(&["ignored", "seen"], "ignored"),
        ),
        parameter(
            "ground-directions",
            "ground=seen: directions that every object looks into",
            ParameterKind::Integer { default: 128, min: 16, max: 4096 },
        ),
        parameter(
            "clamp",
            "hold direct light between 0 and unshadowed, and what is reflected at 0 or more",
            choice(&["off", "on"], "off"),
        ),
        parameter(
            "normals",
            "cells from the centre of the table over normals to its side",
            ParameterKind::Integer { default: 32, min: 2, max: 128 },
        ),
    ]
}
