//! Triangle meshes in object space.

use glam::Vec3;

/// A triangle mesh with a normal per vertex.
///
/// Triangles wind counter-clockwise seen from outside. Every vertex is a receiver.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per position.
    pub normals: Vec<Vec3>,
    /// Vertex colours that multiply the albedo, in [0, 1]; empty, or one per position.
    pub colors: Vec<Vec3>,
    /// Vertex indices of each triangle, each below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
}
