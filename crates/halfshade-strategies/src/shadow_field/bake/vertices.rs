//! Own occlusion: what an object hides from its own vertices.

use super::basis::Basis;
use crate::shared::triangle_rays::{Start, TriangleRays};
use glam::Vec3;
use halfshade_scene::Mesh;
use rayon::prelude::*;

/// Rays from a mesh's own surface.
pub(crate) struct OwnRays(TriangleRays);

impl OwnRays {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self(TriangleRays::new(mesh))
    }

    pub(crate) fn rays(&self) -> &TriangleRays {
        &self.0
    }

    /// Whether the mesh hides `direction` from a vertex or a point of its surface that may be off it by `rounding`. Below the
    /// tangent plane nothing is asked.
    pub(crate) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3, rounding: f32) -> bool {
        let start = || Start::on_surface(position, normal).rougher(rounding);
        direction.dot(normal) > 0.0 && self.0.blocked(&start(), direction, f32::INFINITY)
    }
}

/// Per vertex the vector of `value(direction, normal, blocked)`; the last tells whether the mesh hides the direction.
pub(crate) fn own_vectors<B: Basis>(
    basis: &B,
    (mesh, rays): (&Mesh, &OwnRays),
    value: impl Fn(Vec3, Vec3, &dyn Fn() -> bool) -> f32 + Sync,
) -> Vec<B::Vector> {
    (mesh.positions.par_iter().zip(&mesh.normals))
        .map(|(&position, &normal)| {
            basis.project(&|direction| value(direction, normal, &|| rays.blocked(position, normal, direction, 0.0)))
        })
        .collect()
}

/// Per vertex the occlusion by its own mesh: O_v [Tamura2006, figure 3], as what is blocked.
pub(crate) fn own_blocked<B: Basis>(basis: &B, mesh_and_rays: (&Mesh, &OwnRays)) -> Vec<B::Vector> {
    own_vectors(basis, mesh_and_rays, |_, _, blocked| f32::from(u8::from(blocked())))
}
