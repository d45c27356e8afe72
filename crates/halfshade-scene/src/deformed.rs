//! Vertices that have left their rest.

use glam::Vec3;
use serde::Serialize;

/// The vertices of a mesh that has left its rest, in the object's space.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Deformed {
    /// Positions, one per vertex.
    pub positions: Vec<Vec3>,
    /// Unit normals, one per vertex.
    pub normals: Vec<Vec3>,
}
