//! The channels of one animation of a glTF document, given to the nodes that they move.

use super::nodes::{PlacedNode, label};
use super::track::weights;
use super::{Animation, Buffers};
use crate::SceneError;
use ::gltf::Document;
use ::gltf::animation::Property;
use ::gltf::json::validation::Checked;

/// Finds an animation and gives its channels to the nodes that they move.
pub(super) fn read_channels(
    document: &Document,
    buffers: &Buffers,
    wanted: &Animation,
    places: &mut [PlacedNode<'_>],
) -> Result<(), SceneError> {
    let known = || {
        let name = |animation: ::gltf::Animation<'_>| match animation.name() {
            Some(name) => format!("{} (`{name}`)", animation.index()),
            None => animation.index().to_string(),
        };
        document.animations().map(name).collect::<Vec<_>>().join(", ")
    };
    let mut found = document.animations().filter(|animation| match wanted {
        Animation::Number(number) => animation.index() == *number,
        Animation::Name(name) => animation.name() == Some(name),
    });
    let animation = match (found.next(), found.next()) {
        (Some(animation), None) => animation,
        (Some(_), Some(_)) => {
            return Err(SceneError::new(format!("more than one animation is called {wanted}"))
                .with_remedy(format!("choose by number; known: {}", known())));
        }
        (None, _) if document.animations().len() == 0 => return Err(SceneError::new("it has no animations")),
        (None, _) => return Err(SceneError::new(format!("it has no animation {wanted}; known: {}", known()))),
    };
    // The crate's validation takes targets for granted, so they are looked at in its JSON first.
    let channels = document.as_json().animations.get(animation.index()).map(|json| &json.channels[..]);
    for (channel, json) in animation.channels().zip(channels.unwrap_or(&[])) {
        let about = |problem: String| SceneError::new(format!("animation {wanted}: {problem}"));
        let Some(place) = places.get_mut(json.target.node.value()) else {
            return Err(about(format!("node {} is named, but doesn't exist", json.target.node.value())));
        };
        match json.target.path {
            Checked::Valid(Property::MorphTargetWeights) => {
                let targets = |mesh: ::gltf::Mesh<'_>| mesh.primitives().map(|p| p.morph_targets().len()).max();
                let Some(count) = place.node.mesh().and_then(targets) else { continue };
                if count == 0 {
                    return Err(about(format!("{}: its mesh has no morph targets to move", label(&place.node))));
                }
                if !place.weights.is_empty() {
                    return Err(about(format!("{}: two channels move its weights", label(&place.node))));
                }
                place.weights = weights(&channel.sampler(), buffers, count)
                    .map_err(|error| about(format!("{}: {}", label(&place.node), error.problem)))?;
            }
            Checked::Valid(property) => {
                let tracks = place.tracks.get_or_insert_default();
                tracks.add(property, &channel.sampler(), buffers).map_err(|error| SceneError {
                    problem: format!("animation {wanted}: {}: {}", label(&place.node), error.problem),
                    ..error
                })?;
            }
            Checked::Invalid => return Err(about("a channel moves what glTF doesn't know".to_owned())),
        }
    }
    Ok(())
}
