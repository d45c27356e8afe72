//! Morph targets: where vertices go as weights grow.

use super::Buffers;
use super::accessor::{of_count, vectors};
use crate::SceneError;
use ::gltf::Node;
use ::gltf::mesh::MorphTarget;
use glam::DVec3;

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

/// The weights of a node's mesh at rest: the node's, else the mesh's, else none.
pub(super) fn weights(node: &Node<'_>) -> Vec<f64> {
    let of_mesh = || node.mesh().and_then(|mesh| mesh.weights());
    node.weights().or_else(of_mesh).unwrap_or_default().iter().copied().map(f64::from).collect()
}
