//! How far a strategy may stray from each property, as fractions of unshadowed radiance, and why.

use crate::{parameters::Subject, scene::Drawn};
use halfshade_scene::light::DistantLight;
use halfshade_strategy::Params;

/// Allowances for one strategy with its parameters; `None`: the method doesn't have the property, and why.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerances {
    /// Radiance below zero.
    pub(crate) below: Allowed,
    /// Radiance above what is there without any blocker.
    pub(crate) above: Allowed,
    /// Under a scale of a power of two, which rounds nothing.
    pub(crate) scaled: Allowed,
    /// Under any other scale, moved and turned.
    pub(crate) turned: Allowed,
    /// Under light that is multiplied.
    pub(crate) linear: Allowed,
    /// Brighter by one blocker more.
    pub(crate) brightened: Allowed,
    /// Between receivers that lie a few roundings apart.
    pub(crate) jump: Allowed,
}

/// A fraction, or why there is none.
pub(crate) type Allowed = Result<f32, &'static str>;

pub(crate) fn of(subject: &Subject<'_>, drawn: &Drawn) -> Tolerances {
    let p = &subject.params;
    match subject.name {
        "unshadowed" => unshadowed(p),
        "ray-traced" => ray_traced(),
        "sh-exp" => sh_exp(p, drawn),
        "shadow-field" => shadow_field(p),
        "cosine-lobe" => cosine_lobe(p),
        other => panic!("what `{other}` promises isn't known here"),
    }
}

/// Scaling and lighting by powers of two changes no digit of the arithmetic; what is left are logarithms and roots.
const EXACT: Allowed = Ok(1e-4);

/// A table over normals with so many cells from its centre to a side: 0.005 of the mean at 32 cells, as the square of a cell's
/// width. It doesn't turn with the scene.
fn table(p: &Params) -> f32 {
    (0.005 * (32.0 / p.integer("normals") as f32).powi(2)).clamp(0.005, 1.0)
}

fn unshadowed(p: &Params) -> Tolerances {
    Tolerances {
        below: Ok(0.0),
        above: EXACT,
        scaled: EXACT,
        turned: Ok(table(p)),
        linear: EXACT,
        brightened: Ok(0.0),
        jump: Ok(0.01),
    }
}

fn ray_traced() -> Tolerances {
    Tolerances {
        below: Ok(0.0),
        // The same directions, of which some are blocked.
        above: EXACT,
        scaled: EXACT,
        turned: Err("directions are drawn about the normal in a frame that doesn't turn with the scene"),
        linear: EXACT,
        brightened: EXACT,
        jump: Err("a ray is blocked or not"),
    }
}

fn sh_exp(p: &Params, drawn: &Drawn) -> Tolerances {
    let bands = p.integer("bands") as f32;
    let environment = &drawn.scene.environment;
    let is_constant = environment.sun.is_none() && matches!(environment.base, DistantLight::Constant(_));
    // What a function of so many bands with values in [0, 1] can be, see the strategy: of a direction's light bands² / 4π
    // is left, and light is a sum of directions. Constant light has the cosine's coefficients.
    let magnitude = if is_constant { bands.min(1.64) } else { bands };
    let clamped = p.choice("clamp") == "on";
    let traced = p.choice("exp") == "traced";
    Tolerances {
        below: Ok(if clamped { 0.0 } else { magnitude }),
        above: Ok(if clamped { 1e-4 } else { magnitude - 1.0 + 1e-3 }),
        scaled: EXACT,
        // Directions of rays don't turn with the scene.
        turned: Ok(table(p) + if traced { 0.1 } else { 0.0 }),
        linear: EXACT,
        brightened: Err("logarithms of few bands ring: a blocker beside a light may brighten it"),
        jump: match () {
            () if p.choice("rule") == "published" => {
                Err("the published rule leaves out spheres whose centre is below the horizon")
            }
            () if p.choice("squaring") == "published" => Err("one squaring more is a step"),
            () if p.choice("levels") != "leaves" => Err("each cluster has its own cut through the hierarchy"),
            () if traced => Err("a ray is blocked or not"),
            () => Ok(0.05),
        },
    }
}

fn shadow_field(_: &Params) -> Tolerances {
    Tolerances {
        below: Ok(1.0),
        above: Ok(1.0),
        scaled: EXACT,
        turned: Ok(0.1),
        linear: EXACT,
        brightened: Ok(0.2),
        jump: Ok(0.1),
    }
}

fn cosine_lobe(p: &Params) -> Tolerances {
    let published = p.choice("order") == "published";
    let shared = p.float("share") > 0.0;
    Tolerances {
        below: EXACT,
        above: EXACT,
        scaled: EXACT,
        turned: Ok(if published || shared { 0.3 } else { 0.1 }),
        linear: EXACT,
        brightened: Ok(if published || shared { 0.3 } else { 0.05 }),
        jump: Ok(0.05),
    }
}
