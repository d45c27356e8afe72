//! Settings as values of the kernel's `override`s.

use crate::pipeline::flag;
use halfshade_scene::spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT};
use halfshade_sh::{
    blocker_table,
    exponential::{MAX_SQUARINGS, SERIES_MAGNITUDE},
    form_factor,
    kernel::BatchExponential,
    mean_normal,
    wgsl::MAX_WGSL_BANDS,
};
use halfshade_strategies::sh_exp::arrays::{CombinationArrays, SceneArrays};

pub(super) type Constants = Vec<(&'static str, f64)>;

/// The wish of the scene or the settings that has no kernel, and what to do instead.
pub(super) fn missing(arrays: &SceneArrays<'_>) -> Option<&'static str> {
    match arrays.combination {
        CombinationArrays::Traced => return Some("exp=traced; take exp=hybrid, or device `cpu`"),
        CombinationArrays::Shares { .. } | CombinationArrays::Exponential(_) | CombinationArrays::Product => {}
    }
    (arrays.bands > MAX_WGSL_BANDS).then_some("more than 6 bands; take fewer, or device `cpu`")
}

/// Those of receivers, and of sample points in the dark.
pub(super) fn constants(arrays: &SceneArrays<'_>) -> [Constants; 2] {
    let (rule, full_height) = match arrays.rule {
        AdjustRule::Continuous => (0.0, FADE_HEIGHT),
        AdjustRule::Covering => (1.0, COVER_HEIGHT),
        AdjustRule::Published => (2.0, 1.0),
    };
    let mut dark = vec![
        ("RULE", rule),
        ("FULL_HEIGHT", full_height),
        ("IS_CLAMPED", flag(arrays.clamp)),
        ("OWN_IS_BAKED", flag(arrays.own.is_some())),
        ("OWN_CELLS", arrays.own.map_or(1.0, |own| own.grid().cells() as f64)),
        ("INTERVALS", blocker_table::INTERVALS as f64),
        ("MAX_SQUARINGS", f64::from(MAX_SQUARINGS)),
        ("SERIES_MAGNITUDE", SERIES_MAGNITUDE),
    ];
    let reflections = arrays.reflections.as_ref();
    let shadows = match arrays.combination {
        CombinationArrays::Exponential(exponential) => {
            let [method, terms, limit] = form(exponential);
            dark.extend([("METHOD", method), ("TERMS", terms), ("MAGNITUDE_LIMIT", limit)]);
            Some(exponential)
        }
        CombinationArrays::Shares { points } => {
            dark.extend([("COMBINATION", 2.0), ("POINTS", points as f64)]);
            None
        }
        CombinationArrays::Product | CombinationArrays::Traced => {
            dark.push(("COMBINATION", 1.0));
            None
        }
    };
    if let Some(exponential) = shadows.or(reflections.map(|reflections| reflections.exponential)) {
        dark.push(("IS_BLENDED", flag(exponential.parts().is_blended)));
    }
    let mut lit = dark.clone();
    if let Some(reflections) = reflections {
        let [method, terms, limit] = form(reflections.exponential);
        lit.extend([
            ("REFLECTS", 1.0),
            ("REFLECTION_METHOD", method),
            ("REFLECTION_TERMS", terms),
            ("REFLECTION_LIMIT", limit),
            ("BY_POWER", flag(reflections.by_power)),
            ("IS_PRECOMPUTED", flag(reflections.is_precomputed)),
            ("IS_QUADRATIC", flag(reflections.is_quadratic)),
            ("FORM_INTERVALS", form_factor::INTERVALS as f64),
            ("KNOWS_RECEIVER", flag(reflections.mean_normal.is_some())),
            ("MEAN_CELLS", mean_normal::CELLS as f64),
        ]);
    }
    [lit, dark]
}

/// Method, powers, and the magnitude at which squaring starts.
fn form(exponential: &BatchExponential) -> [f64; 3] {
    let parts = exponential.parts();
    let method = match (parts.is_linear, parts.series_terms) {
        (true, _) => 2.0,
        (false, None) => 1.0,
        (false, Some(_)) => 0.0,
    };
    let limit = if parts.magnitude_limit.is_finite() { f64::from(parts.magnitude_limit) } else { -1.0 };
    [method, f64::from(parts.series_terms.unwrap_or(1)), limit]
}
