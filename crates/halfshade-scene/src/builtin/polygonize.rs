//! Triangle meshes on the surfaces of implicit bodies.

use super::implicit::{Body, Sample};
use crate::Mesh;
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::DVec3;
use rayon::prelude::*;

/// Rounds of moving vertices along the surface toward the middle of their neighbours.
const RELAXATION_ROUNDS: usize = 4;

/// A triangle whose normal has a smaller cosine with a corner's than this counts as folded over.
const FOLDED: f64 = 0.5;

/// Meshes the surface of `body` by surface nets on a grid of edge length `cell`.
///
/// Surface nets leave vertices off the surface and unevenly spread. They are spread along the surface and then moved
/// onto it along the gradient, so a vertex lies on `f = 0` and its normal is exact: the grid decides only about the
/// triangles. Details thinner than two cells are lost or pinch the surface.
pub(super) fn polygonize(body: &Body, cell: f64) -> Mesh {
    let (low, high) = body.bounds();
    let cells = ((high - low) / cell).ceil().as_u64vec3();
    // Centred, so that a symmetric body gets a symmetric grid; two cells of margin, since the body must not touch it.
    let size = [cells.x, cells.y, cells.z].map(|n| n as u32 + 5);
    let extent = DVec3::from_array(size.map(|n| f64::from(n - 1) * cell));
    let origin = 0.5 * (low + high - extent);
    let shape = RuntimeShape::<u32, 3>::new(size);
    let values: Vec<f32> = (0..shape.size())
        .into_par_iter()
        .map(|i| {
            let corner = shape.delinearize(i).map(f64::from);
            body.sample(origin + cell * DVec3::from_array(corner)).value as f32
        })
        .collect();
    let mut net = SurfaceNetsBuffer::default();
    surface_nets(&values, &shape, [0; 3], size.map(|n| n - 1), &mut net);

    let triangles: Vec<[u32; 3]> = net.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let mut vertices: Vec<Vertex> = net
        .positions
        .par_iter()
        .map(|&position| project(body, origin + cell * DVec3::from_array(position.map(f64::from)), cell))
        .collect();
    for _ in 0..RELAXATION_ROUNDS {
        vertices = relax(body, &vertices, &triangles, cell);
    }
    Mesh {
        positions: vertices.iter().map(|(point, _)| point.as_vec3()).collect(),
        normals: vertices.iter().map(|(_, sample)| sample.gradient.normalize().as_vec3().normalize()).collect(),
        colors: vertices.iter().map(|(_, sample)| sample.color).collect(),
        triangles,
        ..Mesh::default()
    }
}

/// A point, and the body there.
type Vertex = (DVec3, Sample);

/// The surface point that Newton's method reaches from `point`, each step at most a cell.
fn project(body: &Body, mut point: DVec3, cell: f64) -> Vertex {
    let mut sample = body.sample(point);
    for _ in 0..20 {
        if sample.value.abs() < 1e-10 {
            break;
        }
        let step = sample.value / sample.gradient.length_squared().max(1e-6) * sample.gradient;
        point -= step.clamp_length_max(cell);
        sample = body.sample(point);
    }
    (point, sample)
}

/// Moves every vertex halfway to the mean of its neighbours, tangentially, and back onto the surface.
///
/// In a narrow crease this can fold triangles over; the corners of those stay where they were.
fn relax(body: &Body, vertices: &[Vertex], triangles: &[[u32; 3]], cell: f64) -> Vec<Vertex> {
    let mut neighbours = vec![(DVec3::ZERO, 0.0); vertices.len()];
    for triangle in triangles {
        for corner in 0..3 {
            let [from, to] = [triangle[corner] as usize, triangle[(corner + 1) % 3] as usize];
            neighbours[from].0 += vertices[to].0;
            neighbours[from].1 += 1.0;
            neighbours[to].0 += vertices[from].0;
            neighbours[to].1 += 1.0;
        }
    }
    let moved: Vec<Vertex> = vertices
        .par_iter()
        .zip(neighbours)
        .map(|((point, sample), (sum, count))| {
            let normal = sample.gradient.normalize();
            let move_by = 0.5 * (sum / f64::max(count, 1.0) - point);
            project(body, point + move_by - move_by.dot(normal) * normal, cell)
        })
        .collect();
    let mut kept = moved.clone();
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| moved[i].0);
        let facing = (b - a).cross(c - a).normalize_or_zero();
        if corners.iter().any(|&i| facing.dot(moved[i].1.gradient.normalize()) < FOLDED) {
            corners.iter().for_each(|&i| kept[i] = vertices[i]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use glam::{DQuat, Vec3};
    use std::f64::consts::PI;

    #[test]
    fn an_ellipsoid_is_meshed_with_its_volume_and_normals() {
        let radii = DVec3::new(0.5, 0.3, 0.8);
        let turn = DQuat::from_rotation_x(0.7);
        let body = Body::new(0.1).ellipsoid([0.2, 1.0, -3.0], radii.to_array(), turn, 0.0, Vec3::ONE);
        let mesh = polygonize(&body, 0.04);
        let volume = check_solid(&mesh) / (4.0 / 3.0 * PI * radii.element_product());
        assert!((0.99..1.0).contains(&volume), "{volume}");
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let p = turn.conjugate() * (position.as_dvec3() - DVec3::new(0.2, 1.0, -3.0));
            assert!(((p / radii).length() - 1.0).abs() < 2e-6);
            let exact = turn * (p / (radii * radii)).normalize();
            assert!(exact.as_vec3().distance(*normal) < 1e-5);
        }
    }

    #[test]
    fn meshing_repeats_bit_by_bit() {
        let body = Body::new(0.1).sphere([0.0; 3], 0.5, 0.0, Vec3::X).sphere([0.6, 0.0, 0.0], 0.3, 0.2, Vec3::Y);
        assert_eq!(polygonize(&body, 0.07), polygonize(&body, 0.07));
        check_solid(&polygonize(&body, 0.07));
    }
}
