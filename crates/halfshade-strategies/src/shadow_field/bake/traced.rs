//! Rays in the place of a field, `sampling=traced`: slow, to tell what interpolation and products cost.

use super::{basis::Basis, bounds::BoundingSphere, vertices::OwnRays};
use glam::Vec3;

/// The triangles of one mesh.
pub(crate) struct TracedMesh {
    pub(crate) rays: OwnRays,
    pub(crate) bounds: BoundingSphere,
}

impl TracedMesh {
    /// Occlusion from a point in the mesh's space, relative to the centre of its bounding sphere.
    pub(crate) fn blocked_from<B: Basis>(&self, basis: &B, point: Vec3) -> B::Vector {
        basis.blocked_from(self.rays.rays(), point + self.bounds.center, self.bounds)
    }
}
