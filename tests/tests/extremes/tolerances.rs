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
    /// Bands of what rings about both, see `ringing`.
    pub(crate) rings: Option<f32>,
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
        "ray-traced" => ray_traced(p, drawn),
        "sh-exp" => sh_exp(p, drawn),
        "shadow-field" => shadow_field(p, drawn),
        "cosine-lobe" => cosine_lobe(p),
        "mask" => mask(),
        "analytic" => analytic(drawn),
        "prt" => prt(p, drawn),
        other => panic!("what `{other}` promises isn't known here"),
    }
}

/// Scaling and lighting by powers of two changes no digit of the arithmetic; what is left are logarithms and roots.
const EXACT: Allowed = Ok(1e-4);

/// Rounding of coordinates up to which a scene and the same scene moved, turned or scaled are the same.
pub(crate) const WELL_CONDITIONED: f32 = 1e-5;

const RAYS: &str = "a ray is blocked or not";
const CENTRES: &str = "the published rule leaves out spheres whose centre is below the horizon";
const GROUND: &str = "what the ground takes is an affine function of the place, which may take less than nothing";

/// Whether all light is a constant sky, of which SH need one coefficient.
fn is_constant(drawn: &Drawn) -> bool {
    let environment = &drawn.scene.environment;
    let is_constant = environment.sun.is_none() && matches!(environment.base, DistantLight::Constant(_));
    is_constant && drawn.scene.lights.is_empty()
}

/// A table over normals with so many cells from its centre to a side: 0.005 of the mean at 32 cells, as the square of a
/// cell's width. It doesn't turn with the scene.
fn table(p: &Params) -> f32 {
    (0.005 * (32.0 / p.number("normals") as f32).powi(2)).clamp(0.005, 1.0)
}

fn unshadowed(p: &Params) -> Tolerances {
    Tolerances {
        below: Ok(0.0),
        above: EXACT,
        rings: None,
        scaled: EXACT,
        turned: Ok(table(p)),
        linear: EXACT,
        brightened: Ok(0.0),
        jump: Ok(0.01),
    }
}

fn ray_traced(p: &Params, drawn: &Drawn) -> Tolerances {
    let is_filtered = p.word("filter") != "none";
    Tolerances {
        below: Ok(0.0),
        // The same directions, of which some are blocked.
        above: EXACT,
        rings: None,
        scaled: EXACT,
        turned: Err("directions are drawn about the normal in a frame that doesn't turn with the scene"),
        linear: EXACT,
        // The space that rays are traced in is about all objects, which one more moves: rays along surfaces may meet them.
        brightened: match () {
            () if drawn.is_touching || drawn.rounding() > WELL_CONDITIONED => Err(RAYS),
            () if is_filtered => {
                Err("who is darker hears less of neighbours that have stayed bright, and more of others")
            }
            () => Ok(1e-3),
        },
        jump: Err(RAYS),
    }
}

fn sh_exp(p: &Params, drawn: &Drawn) -> Tolerances {
    let bands = p.number("bands") as f32;
    // Bound of a function of so many bands with values in [0, 1], see the strategy: of a direction's light bands² / 4π
    // is left, and light is a sum of directions. Constant light has the cosine's coefficients.
    let magnitude = if is_constant(drawn) { bands.min(1.64) } else { bands };
    let clamped = p.word("clamp") == "on";
    let takes = !clamped && p.word("ground") == "seen";
    let traced = p.word("exp") == "traced";
    Tolerances {
        below: match () {
            () if takes => Err(GROUND),
            () if clamped => Ok(0.0),
            () => Ok(magnitude),
        },
        above: match () {
            () if takes => Err(GROUND),
            () if clamped => EXACT,
            () => Ok(magnitude - 1.0 + 1e-3),
        },
        rings: None,
        scaled: EXACT,
        turned: match () {
            () if p.word("rule") == "published" => Err(CENTRES),
            // Directions of rays don't turn with the scene.
            () => Ok(table(p) + if traced { 0.1 } else { 0.0 }),
        },
        linear: EXACT,
        brightened: Err("logarithms of few bands ring: a blocker beside a light may brighten it"),
        jump: match () {
            () if p.word("rule") == "published" => Err(CENTRES),
            () if p.word("squaring") == "published" => Err("one squaring more is a step"),
            () if p.word("levels") != "leaves" => Err("each cluster has its own cut through the hierarchy"),
            () if traced => Err(RAYS),
            () => Ok(0.05),
        },
    }
}

fn shadow_field(p: &Params, drawn: &Drawn) -> Tolerances {
    let sampling = p.word("sampling");
    let is_haar = p.word("basis") == "haar";
    let rings = !is_haar && !is_constant(drawn);
    let are_rays = matches!(sampling, "traced" | "together");
    // A cosine added up over so many texels along an edge of a map, where it isn't known in closed form.
    let texels = p.number("map") as f32;
    let is_added_up = !is_haar && (p.word("own") == "projected" || sampling == "together");
    let added_up = if is_added_up { 0.01 * (8.0 / texels).powi(2) } else { 0.0 };
    Tolerances {
        below: EXACT,
        above: Ok(1e-3 + added_up),
        rings: rings.then(|| p.number("bands") as f32),
        scaled: EXACT,
        turned: if are_rays { Err(RAYS) } else { Ok(0.01) },
        linear: EXACT,
        brightened: match () {
            // In a space about the middle of all objects, which one more moves.
            () if are_rays => Err(RAYS),
            () if rings => Err("a product of few bands rings: a blocker beside a light may brighten it"),
            // Each product is held to what was there before it, but one more before it changes what it is cut off at.
            () if !is_haar => Ok(0.05 + added_up),
            () => Ok(1e-3),
        },
        jump: match () {
            () if are_rays => Err(RAYS),
            () if !drawn.scene.lights.is_empty() => Err("an object is before a lamp or behind it, as its middle is"),
            () => Ok(0.05),
        },
    }
}

fn cosine_lobe(p: &Params) -> Tolerances {
    let published = p.word("order") == "published";
    let shared = p.number("share") > 0.0;
    let cells = p.word("leaves") != "fraction";
    Tolerances {
        below: EXACT,
        above: EXACT,
        rings: None,
        scaled: EXACT,
        turned: match () {
            () if shared => Err("cubes of space don't turn with the scene"),
            () if cells => Err("the cells before a light don't turn with the scene"),
            () if p.word("rule") == "published" => Err(CENTRES),
            () => Ok(0.1),
        },
        linear: EXACT,
        brightened: match () {
            () if shared => Err("cubes of space lie about the middle of all objects, which one more moves"),
            () => Ok(if published { 0.3 } else { 0.05 }),
        },
        jump: match () {
            () if shared => Err("cubes of space end somewhere"),
            () if cells => Err("a cell is covered or not"),
            () if p.number("threshold") > 0.001 => Err("a product is left out or not"),
            () if p.word("rule") == "published" => Err(CENTRES),
            () => Ok(0.05),
        },
    }
}

fn mask() -> Tolerances {
    Tolerances {
        below: Ok(0.0),
        // The table of a map without its lamps and of the lamps, instead of the whole.
        above: Ok(0.02),
        rings: None,
        scaled: EXACT,
        turned: Err("directions don't turn with the scene"),
        linear: EXACT,
        brightened: Ok(1e-3),
        jump: Err("receivers whose normals are nearer to another node look into other directions"),
    }
}

fn analytic(drawn: &Drawn) -> Tolerances {
    Tolerances {
        below: Ok(0.0),
        above: Ok(0.02),
        rings: None,
        scaled: EXACT,
        turned: Ok(0.02),
        linear: EXACT,
        brightened: Ok(1e-3),
        jump: match () {
            () if !drawn.scene.lights.is_empty() => Err("a sphere is before a lamp or behind it, as its centre is"),
            () => Ok(0.05),
        },
    }
}

fn prt(p: &Params, drawn: &Drawn) -> Tolerances {
    // Lobes of few bands ring as light does.
    let rings = !is_constant(drawn) || drawn.scene.is_glossy();
    const SHARED: &str = "a cluster's vectors stand for each other's";
    const VOLUME: &str = "three bands of light between points of a grid, without shadows of what moves";
    const POINTS: &str = "light between points of a grid that lies along axes, near a lamp far from what it is";
    let is_compressed = p.word("compression") != "none";
    let is_between = p.number("lamp-steps") > 0.0 && !drawn.scene.lights.is_empty();
    if is_compressed || p.word("moving") == "volume" || is_between {
        let none = match () {
            () if is_between => Err(POINTS),
            () if is_compressed => Err(SHARED),
            () => Err(VOLUME),
        };
        let (below, above, brightened, jump) = (none, none, none, none);
        let turned = if is_compressed && !is_between { EXACT } else { none };
        return Tolerances { below, above, rings: None, scaled: EXACT, turned, linear: EXACT, brightened, jump };
    }
    Tolerances {
        // Sums over rays have weights that are exact for the light's first band.
        below: EXACT,
        above: EXACT,
        // Zonal light has three, whatever is asked.
        rings: rings.then(|| if p.word("light") == "sh" { p.number("bands") as f32 } else { 3.0 }),
        scaled: EXACT,
        // Vectors stay, the light is turned.
        turned: EXACT,
        linear: EXACT,
        brightened: match () {
            () if rings => Err("light of few bands rings: a blocker may take what is below zero"),
            // In a space about the middle of all objects, which one more moves.
            () if drawn.is_touching || drawn.rounding() > WELL_CONDITIONED => Err(RAYS),
            () => Ok(1e-3),
        },
        jump: Ok(0.05),
    }
}
