//! The vertices of an object: what it hides from them itself, and the way from a receiver to its vertex.

use super::{
    PART,
    basis::{Basis, rays},
};
use crate::triangle_rays::{Start, TriangleRays};
use glam::Vec3;
use halfshade_scene::Mesh;
use parry3d::{query::PointQueryWithLocation, shape::TriMesh};
use rayon::prelude::*;
use std::sync::Arc;

/// Rays from a mesh's own surface.
pub(super) struct OwnRays(TriangleRays);

impl OwnRays {
    pub(super) fn new(mesh: &Mesh) -> Self {
        Self(rays(mesh))
    }

    pub(super) fn rays(&self) -> &TriangleRays {
        &self.0
    }

    /// Whether the mesh hides `direction` from a vertex or a point of its surface that may be off it by `rounding`. Below the
    /// tangent plane nothing is asked.
    pub(super) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3, rounding: f32) -> bool {
        let start = || Start::on_surface(position, normal).rougher(rounding);
        direction.dot(normal) > 0.0 && self.0.blocked(&start(), direction, f32::INFINITY)
    }
}

/// Per vertex the vector of `value(direction, normal, blocked)`; the last tells whether the mesh hides the direction.
pub(super) fn own_vectors<B: Basis>(
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

/// Per vertex what its own mesh hides: O_v [Tamura2006, figure 3], as what is blocked.
pub(super) fn own_blocked<B: Basis>(basis: &B, of: (&Mesh, &OwnRays)) -> Vec<B::Vector> {
    own_vectors(basis, of, |_, _, blocked| f32::from(u8::from(blocked())))
}

/// The vertices of a mesh, and what lies between them.
pub(super) struct Vertices {
    mesh: Arc<Mesh>,
    /// `None` without a triangle.
    surface: Option<TriMesh>,
    /// Means of the vertices of each part; at least one.
    pub(super) part_centers: Vec<Vec3>,
}

/// A point, or the place of the surface next to it, as a weighted mean of vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    vertices: [usize; 3],
    /// Of sum 1.
    weights: [f32; 3],
    /// Whether the point is the first vertex. A point off the surface may only have that one next to it.
    pub(super) is_vertex: bool,
}

impl Between {
    /// The vertex itself.
    pub(super) const fn at(vertex: usize) -> Self {
        Self { vertices: [vertex; 3], weights: [1.0, 0.0, 0.0], is_vertex: true }
    }

    /// Vertices that count.
    #[inline]
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        self.vertices.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }
}

impl Vertices {
    pub(super) fn new(mesh: &Arc<Mesh>) -> Self {
        let mut part_centers: Vec<Vec3> =
            mesh.positions.chunks(PART).map(|part| part.iter().sum::<Vec3>() / part.len() as f32).collect();
        if part_centers.is_empty() {
            part_centers.push(Vec3::ZERO);
        }
        let is_finite = |corners: &&[u32; 3]| corners.iter().all(|&corner| mesh.positions[corner as usize].is_finite());
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(is_finite).copied().collect();
        let surface =
            TriMesh::new(mesh.positions.iter().map(|point| point.to_array().into()).collect(), triangles).ok();
        Self { mesh: mesh.clone(), surface, part_centers }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The vertex `guess`, if it is within `tolerance` of `point`; otherwise the nearest place of the surface.
    pub(super) fn find(&self, guess: Option<usize>, point: Vec3, tolerance: f32) -> Option<Between> {
        let is_there = |vertex: &usize| {
            self.mesh.positions.get(*vertex).is_some_and(|place| place.distance_squared(point) <= tolerance * tolerance)
        };
        guess.filter(is_there).map(Between::at).or_else(|| self.nearest(point))
    }

    fn nearest(&self, point: Vec3) -> Option<Between> {
        let surface = self.surface.as_ref()?;
        let (_, (triangle, location)) = surface.project_local_point_and_get_location(point.to_array().into(), false);
        let vertices = surface.indices().get(triangle as usize)?.map(|vertex| vertex as usize);
        // A triangle without extent has no such coordinates.
        let weights = location.barycentric_coordinates().filter(|weights| weights.iter().all(|x| x.is_finite()));
        Some(Between { vertices, weights: weights.unwrap_or([1.0, 0.0, 0.0]), is_vertex: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin::shapes;

    #[test]
    fn the_nearest_place_of_the_surface_is_found() {
        let vertices = Vertices::new(&Arc::new(shapes::plane(7)));
        let positions = &vertices.mesh().positions;
        assert_eq!(vertices.find(Some(20), positions[20], 1e-4), Some(Between::at(20)));
        // Not there: from above some place of the square.
        for (x, z) in [(0.31, -0.77), (-0.95, 0.02), (0.0, 0.5)] {
            let between = vertices.find(Some(20), Vec3::new(x, 0.4, z), 1e-4).unwrap();
            let found: Vec3 = between.parts().map(|(vertex, weight)| weight * positions[vertex]).sum();
            assert!(found.distance(Vec3::new(x, 0.0, z)) < 1e-5, "{found} {between:?}");
        }
        // Above a corner the vertex is next, but the point isn't it: its normal needn't be the vertex's.
        let above = vertices.find(None, positions[0] + Vec3::Y, 1e-4).unwrap();
        assert!(!above.is_vertex);
        assert!(above.parts().all(|(vertex, _)| vertex == 0), "{above:?}");
        assert!(vertices.find(None, Vec3::NAN, 1e-4).is_some());
        assert_eq!(Vertices::new(&Arc::default()).find(Some(0), Vec3::ZERO, 1e-4), None);
        let point = Mesh {
            positions: vec![Vec3::ONE; 3],
            normals: vec![Vec3::Y; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let found = Vertices::new(&Arc::new(point)).find(None, Vec3::X, 1e-4).unwrap();
        assert!((found.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}
