//! What an object hides from its own vertices [Tamura2006, 3.1].

use super::{PART, occlusion::Directions};
use crate::triangle_rays::TriangleRays;
use glam::Vec3;
use halfshade_scene::{Mesh, mesh};
use rayon::prelude::*;
use std::{collections::HashMap, f32::consts::FRAC_1_PI, sync::Arc};

/// How far rays start above the surface, in units of the traced space, of which the mesh fills 1024: 1e-5 of its extent.
const LIFT: f32 = 1e-2;

/// What is known at every vertex, in the object's space.
#[derive(Debug)]
pub(super) struct OwnOcclusion {
    pub(super) kind: Kind,
    count: usize,
    vectors: Vec<f32>,
    mesh: Arc<Mesh>,
    nearest: Cells,
    /// Means of the vertices of each part; at least one.
    pub(super) part_centers: Vec<Vec3>,
}

/// What vectors are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// O_v, the visibility that the object leaves above the vertex, to be multiplied with ρ̂ when shading
    /// [Tamura2006, figure 3].
    Visibility,
    /// Visibility times the cosine over π, projected as it is; for receivers that are vertices.
    Transfer,
}

/// Vertices by cells of a grid, for points between them.
#[derive(Debug, Default)]
struct Cells {
    size: f32,
    vertices: HashMap<[i32; 3], Vec<u32>>,
}

impl OwnOcclusion {
    /// The vectors of all vertices, one after another.
    pub(super) fn vectors(mesh: &Mesh, rays: &TriangleRays, directions: &Directions, kind: Kind) -> Vec<f32> {
        let lift = LIFT + 2.0 * rays.coarseness();
        let vectors: Vec<Vec<f32>> = (mesh.positions.par_iter().zip(&mesh.normals))
            .map(|(&position, &normal)| {
                let blocked = |cell: usize| {
                    let direction = directions.cells[cell].0;
                    direction.dot(normal) > 0.0 && rays.blocked(position, lift * normal, direction, f32::INFINITY)
                };
                match kind {
                    Kind::Visibility => directions.visibility(blocked),
                    Kind::Transfer => {
                        directions.weighted(|direction| FRAC_1_PI * direction.dot(normal).max(0.0), blocked)
                    }
                }
            })
            .collect();
        vectors.concat()
    }

    /// Of a mesh, from its [`vectors`](Self::vectors) of `count` coefficients.
    pub(super) fn new(mesh: &Arc<Mesh>, kind: Kind, count: usize, vectors: Vec<f32>) -> Self {
        let mut part_centers: Vec<Vec3> =
            mesh.positions.chunks(PART).map(|part| part.iter().sum::<Vec3>() / part.len() as f32).collect();
        if part_centers.is_empty() {
            part_centers.push(Vec3::ZERO);
        }
        Self { kind, count, vectors, mesh: mesh.clone(), nearest: Cells::new(&mesh.positions), part_centers }
    }

    /// The vector of the vertex at `point`, if `guess` is within `tolerance` of it; otherwise that of the nearest vertex, and
    /// `false`.
    pub(super) fn at(&self, guess: Option<usize>, point: Vec3, tolerance: f32) -> Option<(&[f32], bool)> {
        let is_there = |vertex: &usize| {
            self.mesh.positions.get(*vertex).is_some_and(|place| place.distance_squared(point) <= tolerance * tolerance)
        };
        let guess = guess.filter(is_there);
        let vertex = guess.or_else(|| self.nearest.find(&self.mesh.positions, point))?;
        Some((&self.vectors[vertex * self.count..][..self.count], guess.is_some()))
    }

    /// Memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.vectors.as_slice())
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
