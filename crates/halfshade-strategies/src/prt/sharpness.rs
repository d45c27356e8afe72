//! How sharp gloss may be for a number of bands.
//!
//! Of band l a lobe of exponent e keeps about `exp(-l²/2e)`: past a few times the root of e there is nothing, before it what isn't
//! there is missed. Measured against the truth in captured light, without any diffuse part, the error of n bands stays below a
//! tenth of the unshadowed radiance up to about `e = n²/4`: 4 at 4 bands, 16 at 8. Under a constant sky, where a lobe of any exponent
//! has its closed form, errors are those of the shadows in it. A test holds the rule to the truth (`tests/prt/gloss.rs`).

use halfshade_scene::{Progress, Reflectance, Scene};

/// The largest exponent that so many bands show.
pub fn shown_exponent(bands: usize) -> f64 {
    0.25 * (bands * bands) as f64
}

/// The largest exponent of a scene, and the object that has it; nothing where none is glossy.
pub(crate) fn sharpest(scene: &Scene) -> Option<(&str, f64)> {
    let glossy = scene.objects.iter().filter(|object| object.material.is_glossy());
    let exponents = glossy.map(|object| (object.name.as_str(), exponent(&object.material.reflectance)));
    exponents.reduce(|a, b| if b.1 > a.1 { b } else { a })
}

/// Tells where gloss is sharper than bands show.
pub(crate) fn note(scene: &Scene, bands: usize, progress: &dyn Progress) {
    let shown = shown_exponent(bands);
    if let Some((name, exponent)) = sharpest(scene).filter(|(_, exponent)| *exponent > shown) {
        progress.note(&format!(
            "prt: {bands} bands show gloss of exponents up to about {shown}, and `{name}` has {exponent}: its highlights will be blurred and may ring; take more bands, or mask or ray-traced"
        ));
    }
}

fn exponent(reflectance: &Reflectance) -> f64 {
    match reflectance {
        Reflectance::Lambert => 0.0,
        Reflectance::Phong { exponent, .. } | Reflectance::ModifiedPhong { exponent, .. } => f64::from(*exponent),
        Reflectance::Lafortune { lobes } => lobes.iter().map(|lobe| f64::from(lobe.exponent)).fold(0.0, f64::max),
    }
}
