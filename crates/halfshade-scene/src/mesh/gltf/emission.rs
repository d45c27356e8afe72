//! Light that materials emit, which no surface here does.

use ::gltf::json::{self, Root};

/// Tells people how many materials emit light.
pub(super) fn emission_note(json: &Root) -> Option<String> {
    let emits = |material: &&json::Material| material.emissive_factor.0.into_iter().any(|factor| factor > 0.0);
    match json.materials.iter().filter(emits).count() {
        0 => None,
        count => Some(format!("light that materials emit left out: {count}")),
    }
}
