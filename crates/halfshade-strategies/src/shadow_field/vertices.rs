//! The vertices of an object: what it hides from them itself, and the way from a receiver to its vertex.

use super::{
    PART,
    basis::{Basis, rays},
};
use crate::triangle_rays::TriangleRays;
use glam::Vec3;
use halfshade_scene::{Mesh, mesh};
use rayon::prelude::*;
use std::{collections::HashMap, sync::Arc};

/// How far rays start above the surface, in units of the traced space, of which the mesh fills 1024: 1e-5 of its extent.
const LIFT: f32 = 1e-2;

/// Rays from a mesh's own surface.
pub(super) struct OwnRays {
    rays: TriangleRays,
    lift: f32,
}

impl OwnRays {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let rays = rays(mesh);
        let lift = LIFT + 2.0 * rays.coarseness();
        Self { rays, lift }
    }

    pub(super) fn rays(&self) -> &TriangleRays {
        &self.rays
    }

    /// Whether the mesh hides `direction` from a point of its surface. Below the tangent plane nothing is asked.
    pub(super) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3) -> bool {
        direction.dot(normal) > 0.0 && self.rays.blocked(position, self.lift * normal, direction, f32::INFINITY)
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
            basis.project(&|direction| value(direction, normal, &|| rays.blocked(position, normal, direction)))
        })
        .collect()
}

/// Per vertex what its own mesh hides: O_v [Tamura2006, figure 3], as what is blocked.
pub(super) fn own_blocked<B: Basis>(basis: &B, of: (&Mesh, &OwnRays)) -> Vec<B::Vector> {
    own_vectors(basis, of, |_, _, blocked| f32::from(u8::from(blocked())))
}

/// The vertices of a mesh.
#[derive(Debug)]
pub(super) struct Vertices {
    mesh: Arc<Mesh>,
    nearest: Cells,
    /// Means of the vertices of each part; at least one.
    pub(super) part_centers: Vec<Vec3>,
}

/// Vertices by cells of a grid, for points between them.
#[derive(Debug, Default)]
struct Cells {
    size: f32,
    vertices: HashMap<[i32; 3], Vec<u32>>,
}

impl Vertices {
    pub(super) fn new(mesh: &Arc<Mesh>) -> Self {
        let mut part_centers: Vec<Vec3> =
            mesh.positions.chunks(PART).map(|part| part.iter().sum::<Vec3>() / part.len() as f32).collect();
        if part_centers.is_empty() {
            part_centers.push(Vec3::ZERO);
        }
        Self { mesh: mesh.clone(), nearest: Cells::new(&mesh.positions), part_centers }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The vertex at `point`, if `guess` is within `tolerance` of it; otherwise the nearest, and `false`.
    pub(super) fn find(&self, guess: Option<usize>, point: Vec3, tolerance: f32) -> Option<(usize, bool)> {
        let is_there = |vertex: &usize| {
            self.mesh.positions.get(*vertex).is_some_and(|place| place.distance_squared(point) <= tolerance * tolerance)
        };
        let guess = guess.filter(is_there);
        let vertex = guess.or_else(|| self.nearest.find(&self.mesh.positions, point))?;
        Some((vertex, guess.is_some()))
    }
}

impl Cells {
    fn new(positions: &[Vec3]) -> Self {
        let (low, high) = mesh::bounds(positions).unwrap_or_default();
        // A surface fills about as many cells as the square of the number along a side.
        let size = (high - low).max_element() / (positions.len() as f32).sqrt().max(1.0);
        let mut cells = Self { size: if size > 0.0 { size } else { 1.0 }, vertices: HashMap::new() };
        for (vertex, &position) in positions.iter().enumerate() {
            cells.vertices.entry(cells.cell(position)).or_default().push(vertex as u32);
        }
        cells
    }

    fn cell(&self, point: Vec3) -> [i32; 3] {
        (point / self.size).to_array().map(|x| x.floor() as i32)
    }

    /// The nearest vertex, if it is among the next cells; otherwise the nearest of all.
    fn find(&self, positions: &[Vec3], point: Vec3) -> Option<usize> {
        let [x, y, z] = self.cell(point);
        let near = (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [i, j, k])));
        let place = |[i, j, k]: [i32; 3]| [x.saturating_add(i), y.saturating_add(j), z.saturating_add(k)];
        let distance = |vertex: &usize| positions[*vertex].distance_squared(point);
        near.filter_map(|offset| self.vertices.get(&place(offset)))
            .flatten()
            .map(|&vertex| vertex as usize)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .or_else(|| (0..positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))))
    }
}
