//! The nodes of a glTF document: where each is, and which one above moves it.

use super::track::{Tracks, Weights, pose_of};
use crate::{Pose, SceneError};
use ::gltf::scene::Transform;
use ::gltf::{Document, Node};
use glam::{DMat4, DQuat, DVec3};

/// A node of the document.
pub(super) struct PlacedNode<'a> {
    pub(super) node: Node<'a>,
    pub(super) parent: Option<usize>,
    pub(super) parent_from_node: DMat4,
    /// The node's transform as the document has it, without an animation.
    pub(super) world_from_node: DMat4,
    /// The nearest node, itself or above, that the animation moves; without one, the world.
    pub(super) moved: Option<usize>,
    /// Transform from the node's space into that of `moved`.
    pub(super) moved_from_node: DMat4,
    pub(super) tracks: Option<Tracks>,
    /// Animated weights of its mesh's morph targets.
    pub(super) weights: Vec<Weights>,
    /// Index among the joints, once it is one.
    pub(super) joint: Option<usize>,
}

/// The nodes of a document, without an animation.
pub(super) fn places(document: &Document) -> Result<Vec<PlacedNode<'_>>, SceneError> {
    let parents = parents(document)?;
    Ok((document.nodes().zip(parents))
        .map(|(node, parent)| {
            let parent_from_node = world_from(&node, DMat4::IDENTITY);
            let (world_from_node, moved_from_node) = (DMat4::IDENTITY, DMat4::IDENTITY);
            let (moved, tracks, weights, joint) = (None, None, Vec::new(), None);
            PlacedNode {
                node,
                parent,
                parent_from_node,
                world_from_node,
                moved,
                moved_from_node,
                tracks,
                weights,
                joint,
            }
        })
        .collect())
}

/// Finds for each node where it is and which node moves it, once those that the animation moves are known.
pub(super) fn follow_moved(places: &mut [PlacedNode<'_>]) -> Result<(), SceneError> {
    for index in parents_first(places)? {
        let above = places[index].parent.map(|parent| &places[parent]);
        let (world, moved, moved_from_parent) =
            above.map_or((DMat4::IDENTITY, None, DMat4::IDENTITY), |p| (p.world_from_node, p.moved, p.moved_from_node));
        let place = &mut places[index];
        place.world_from_node = world * place.parent_from_node;
        (place.moved, place.moved_from_node) = if place.tracks.is_some() {
            (Some(index), DMat4::IDENTITY)
        } else {
            (moved, moved_from_parent * place.parent_from_node)
        };
    }
    Ok(())
}

/// The place of a node's space in the world, or wherever its parent's is given.
pub(super) fn world_from(node: &Node<'_>, world_from_parent: DMat4) -> DMat4 {
    let local = node.transform().matrix().map(|column| column.map(f64::from));
    world_from_parent * DMat4::from_cols_array_2d(&local)
}

/// A node's name, for messages.
pub(super) fn label(node: &Node<'_>) -> String {
    node.name().map_or_else(|| format!("node {}", node.index()), |name| format!("node `{name}`"))
}

/// Translation, rotation and scale of a node.
pub(super) fn base(place: &PlacedNode<'_>) -> Result<(DVec3, DQuat, DVec3), SceneError> {
    match place.node.transform() {
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let rotation = if rotation.length_squared() < 1e-12 { DQuat::IDENTITY } else { rotation };
            Ok((translation.map(f64::from).into(), rotation, scale.map(f64::from).into()))
        }
        Transform::Matrix { .. } => {
            let Pose { scale, rotation, translation } = pose_of(&place.parent_from_node)?;
            Ok((translation.as_dvec3(), rotation.as_dquat(), DVec3::splat(scale.into())))
        }
    }
}

/// The parent of each node.
fn parents(document: &Document) -> Result<Vec<Option<usize>>, SceneError> {
    let mut parents = vec![None; document.nodes().len()];
    for node in document.nodes() {
        for child in node.children() {
            if parents[child.index()].replace(node.index()).is_some() {
                return Err(SceneError::new(format!("{} has two parents", label(&child))));
            }
        }
    }
    Ok(parents)
}

/// All nodes, parents before their children.
fn parents_first(places: &[PlacedNode<'_>]) -> Result<Vec<usize>, SceneError> {
    let mut order: Vec<usize> = (0..places.len()).filter(|&index| places[index].parent.is_none()).collect();
    let mut next = 0;
    while let Some(&index) = order.get(next) {
        order.extend(places[index].node.children().map(|child| child.index()));
        next += 1;
    }
    if order.len() == places.len() {
        return Ok(order);
    }
    let mut is_reached = vec![false; places.len()];
    order.iter().for_each(|&index| is_reached[index] = true);
    let in_a_loop = places.iter().zip(is_reached).find(|(_, reached)| !reached);
    let name = in_a_loop.map_or_else(String::new, |(place, _)| label(&place.node));
    Err(SceneError::new(format!("{name} is its own ancestor, or below a node that is")))
}
