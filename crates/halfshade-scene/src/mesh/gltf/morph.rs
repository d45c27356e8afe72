//! Morph targets: where vertices go as weights grow.

use super::Buffers;
use super::accessor::{of_count, vectors};
use crate::SceneError;
use ::gltf::Node;
use ::gltf::json::{Root, deserialize};
use ::gltf::mesh::MorphTarget;
use glam::DVec3;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::{BTreeMap, BTreeSet};

/// Shifts of positions and normals for a weight of 1; each empty where nothing shifts. Tangents aren't used.
pub(super) struct Target {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
}

impl Target {
    pub(super) fn read(target: &MorphTarget<'_>, buffers: &Buffers, count: usize) -> Result<Self, SceneError> {
        let read = |accessor: Option<::gltf::Accessor<'_>>, name: &str| {
            let list = accessor.map(|accessor| of_count(vectors(&accessor, buffers)?, count)).transpose();
            list.map(Option::unwrap_or_default)
                .map_err(|error| SceneError { problem: format!("{name}: {}", error.problem), ..error })
        };
        Ok(Self { positions: read(target.positions(), "POSITION")?, normals: read(target.normals(), "NORMAL")? })
    }
}

/// The attributes of morph targets, of which a [`Root`] holds three.
#[derive(Deserialize)]
struct Meshes {
    meshes: Vec<Primitives>,
}

#[derive(Deserialize)]
struct Primitives {
    primitives: Vec<Targets>,
}

#[derive(Deserialize)]
struct Targets {
    targets: Option<Vec<BTreeMap<String, IgnoredAny>>>,
}

/// Tells people what morph targets would change beside shape: colours and texture coordinates.
pub(super) fn note(text: &[u8], json: &Root) -> Option<String> {
    if json.meshes.iter().flat_map(|mesh| &mesh.primitives).all(|primitive| primitive.targets.is_none()) {
        return None;
    }
    let Meshes { meshes } = deserialize::from_slice(text).ok()?;
    let targets = meshes.into_iter().flat_map(|mesh| mesh.primitives).filter_map(|primitive| primitive.targets);
    let names = targets.flatten().flat_map(BTreeMap::into_keys);
    let left_out: BTreeSet<String> =
        names.filter(|name| !["POSITION", "NORMAL", "TANGENT"].contains(&name.as_str())).collect();
    let names = left_out.into_iter().collect::<Vec<_>>().join(", ");
    (!names.is_empty()).then(|| format!("of morph targets only positions and normals are read, left out: {names}"))
}

/// The weights of a node's mesh at rest: the node's, else the mesh's, else none.
pub(super) fn weights(node: &Node<'_>) -> Vec<f64> {
    let of_mesh = || node.mesh().and_then(|mesh| mesh.weights());
    node.weights().or_else(of_mesh).unwrap_or_default().iter().copied().map(f64::from).collect()
}
