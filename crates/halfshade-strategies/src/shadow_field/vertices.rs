//! The vertices of an object: what it hides from them itself, and the way from a receiver to its vertex.

use super::basis::{Basis, rays};
use crate::triangle_rays::{Start, TriangleRays};
use glam::Vec3;
use halfshade_scene::Mesh;
use parry3d::{bounding_volume::Aabb, query::PointQueryWithLocation, shape::TriMesh};
use rayon::prelude::*;
use std::sync::Arc;

/// How far from a place, in radii of what holds the mesh, a point may be that is said to be there.
const SAME_PLACE: f32 = 1e-4;

/// Cosine between normals that are the same: 2.5 degrees.
const SAME_NORMAL: f32 = 0.999;

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
    /// Distance within which two places are one.
    tolerance: f32,
}

/// A point, or the place of the surface next to it, as a weighted mean of vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    vertices: [usize; 3],
    /// Of sum 1.
    weights: [f32; 3],
    /// Whether the point is there, with the normal that the vertices have there: what is only next to a place knows less.
    pub(super) is_there: bool,
}

impl Between {
    /// The vertex itself.
    pub(super) const fn at(vertex: usize) -> Self {
        Self { vertices: [vertex; 3], weights: [1.0, 0.0, 0.0], is_there: true }
    }

    /// Vertices that count.
    #[inline]
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        self.vertices.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }
}

impl Vertices {
    /// Of a mesh within a ball of a radius.
    pub(super) fn new(mesh: &Arc<Mesh>, radius: f32) -> Self {
        let is_finite = |corners: &&[u32; 3]| corners.iter().all(|&corner| mesh.positions[corner as usize].is_finite());
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(is_finite).copied().collect();
        let surface =
            TriMesh::new(mesh.positions.iter().map(|point| point.to_array().into()).collect(), triangles).ok();
        Self { mesh: mesh.clone(), surface, tolerance: SAME_PLACE * radius }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Where a point of unit `normal` is: the vertex `guess`, if that is there and has this normal; otherwise the nearest
    /// place of the surface, and of several, as along an edge, the one whose normal is nearest.
    pub(super) fn find(&self, guess: Option<usize>, point: Vec3, normal: Vec3) -> Option<Between> {
        let is_there = |&vertex: &usize| {
            self.mesh.positions.get(vertex).is_some_and(|place| {
                place.distance_squared(point) <= self.tolerance * self.tolerance
                    && self.mesh.normals[vertex].dot(normal) >= SAME_NORMAL
            })
        };
        guess.filter(is_there).map(Between::at).or_else(|| self.nearest(point, normal))
    }

    fn nearest(&self, point: Vec3, normal: Vec3) -> Option<Between> {
        let surface = self.surface.as_ref()?;
        let place: parry3d::math::Vector = point.to_array().into();
        let (nearest, (triangle, location)) = surface.project_local_point_and_get_location(place, false);
        let distance = (nearest.point - place).length();
        let mut best = self.on_triangle(triangle, location.barycentric_coordinates(), (distance, normal))?;
        if best.1 < SAME_NORMAL {
            // Here faces may meet that know nothing of each other.
            let reach = Aabb::from_half_extents(nearest.point, parry3d::math::Vector::splat(self.tolerance));
            for other in surface.bvh().intersect_aabb(&reach) {
                let (found, location) = surface.triangle(other).project_local_point_and_get_location(place, false);
                let off = (found.point - place).length();
                if off > distance + self.tolerance {
                    continue;
                }
                let there = self.on_triangle(other, location.barycentric_coordinates(), (off, normal))?;
                // More than rounding, so that coplanar neighbours change nothing.
                if there.1 > best.1 + 1e-3 {
                    best = there;
                }
            }
        }
        Some(best.0)
    }

    /// A place of a triangle for a point so far away, and how well the normals agree: the cosine, seen from either side.
    fn on_triangle(
        &self,
        triangle: u32,
        weights: Option<[f32; 3]>,
        (distance, normal): (f32, Vec3),
    ) -> Option<(Between, f32)> {
        let vertices = self.surface.as_ref()?.indices().get(triangle as usize)?.map(|vertex| vertex as usize);
        // A triangle without extent has no such coordinates.
        let weights = weights.filter(|weights| weights.iter().all(|x| x.is_finite())).unwrap_or([1.0, 0.0, 0.0]);
        let mean: Vec3 = vertices.iter().zip(weights).map(|(&vertex, weight)| weight * self.mesh.normals[vertex]).sum();
        let cosine = mean.normalize_or_zero().dot(normal);
        let is_there = distance <= self.tolerance && cosine >= SAME_NORMAL;
        Some((Between { vertices, weights, is_there }, cosine.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin::shapes;

    #[test]
    fn the_nearest_place_of_the_surface_is_found() {
        let vertices = Vertices::new(&Arc::new(shapes::plane(7)), 1.0);
        let positions = &vertices.mesh().positions;
        assert_eq!(vertices.find(Some(20), positions[20], Vec3::Y), Some(Between::at(20)));
        // Not there: from above some place of the square.
        for (x, z) in [(0.31, -0.77), (-0.95, 0.02), (0.0, 0.5)] {
            let between = vertices.find(Some(20), Vec3::new(x, 0.4, z), Vec3::Y).unwrap();
            let found: Vec3 = between.parts().map(|(vertex, weight)| weight * positions[vertex]).sum();
            assert!(found.distance(Vec3::new(x, 0.0, z)) < 1e-5 && !between.is_there, "{found} {between:?}");
        }
        // Above a corner the vertex is next, but the point isn't it: its normal needn't be the vertex's.
        let above = vertices.find(None, positions[0] + Vec3::Y, Vec3::Y).unwrap();
        assert!(!above.is_there);
        assert!(above.parts().all(|(vertex, _)| vertex == 0), "{above:?}");
        assert!(vertices.find(None, Vec3::NAN, Vec3::Y).is_some());
        assert_eq!(Vertices::new(&Arc::default(), 0.0).find(Some(0), Vec3::ZERO, Vec3::Y), None);
        let point = Mesh {
            positions: vec![Vec3::ONE; 3],
            normals: vec![Vec3::Y; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let found = Vertices::new(&Arc::new(point), 0.0).find(None, Vec3::X, Vec3::Y).unwrap();
        assert!((found.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }

    /// Whatever number it has, a point of an edge belongs to the face whose normal it has.
    #[test]
    fn at_an_edge_the_normal_decides() {
        let mesh = Arc::new(shapes::cuboid(Vec3::ONE, [1; 3]));
        let vertices = Vertices::new(&mesh, 2.0);
        for (vertex, (&place, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            for number in [None, Some(vertex), Some(0), Some(23), Some(1000)] {
                let found = vertices.find(number, place, normal).unwrap();
                assert!(found.is_there, "{vertex} {number:?}");
                let weight: f32 = found.parts().filter(|(part, _)| *part == vertex).map(|(_, weight)| weight).sum();
                assert!((weight - 1.0).abs() < 1e-4, "{vertex} {number:?}: {found:?}");
            }
            let middle = 0.5 * (place + mesh.positions[vertex / 4 * 4]);
            let found = vertices.find(Some(vertex), middle, normal).unwrap();
            assert!(found.is_there && found.parts().all(|(part, _)| mesh.normals[part] == normal), "{found:?}");
        }
    }
}
