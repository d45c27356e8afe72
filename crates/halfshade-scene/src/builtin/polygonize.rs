//! From an implicit body to a triangle mesh that lies on it.

use super::implicit::Body;
use crate::Mesh;
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::DVec3;

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
        .map(|i| {
            let corner = shape.delinearize(i).map(f64::from);
            body.sample(origin + cell * DVec3::from_array(corner)).value as f32
        })
        .collect();
    let mut net = SurfaceNetsBuffer::default();
    surface_nets(&values, &shape, [0; 3], size.map(|n| n - 1), &mut net);

    let mut points: Vec<DVec3> =
        net.positions.iter().map(|&p| origin + cell * DVec3::from_array(p.map(f64::from))).collect();
    let triangles: Vec<[u32; 3]> = net.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    points.iter_mut().for_each(|point| *point = project(body, *point, cell));
    for _ in 0..RELAXATION_ROUNDS {
        relax(body, &mut points, &triangles, cell);
    }
    let samples: Vec<_> = points.iter().map(|&point| body.sample(point)).collect();
    Mesh {
        positions: points.iter().map(|point| point.as_vec3()).collect(),
        normals: samples.iter().map(|sample| sample.gradient.normalize().as_vec3().normalize()).collect(),
        colors: samples.iter().map(|sample| sample.color).collect(),
        triangles,
    }
}

/// The surface point that Newton's method reaches from `point`, each step at most a cell.
fn project(body: &Body, mut point: DVec3, cell: f64) -> DVec3 {
    for _ in 0..20 {
        let sample = body.sample(point);
        if sample.value.abs() < 1e-12 {
            break;
        }
        let step = sample.value / sample.gradient.length_squared().max(1e-6) * sample.gradient;
        point -= step.clamp_length_max(cell);
    }
    point
}

/// Moves every vertex halfway to the mean of its neighbours, tangentially, and back onto the surface.
///
/// In a narrow crease this can fold triangles over; the corners of those stay where they were.
fn relax(body: &Body, points: &mut [DVec3], triangles: &[[u32; 3]], cell: f64) {
    let mut sums = vec![(DVec3::ZERO, 0.0); points.len()];
    for triangle in triangles {
        for corner in 0..3 {
            let [from, to] = [triangle[corner] as usize, triangle[(corner + 1) % 3] as usize];
            sums[from].0 += points[to];
            sums[from].1 += 1.0;
            sums[to].0 += points[from];
            sums[to].1 += 1.0;
        }
    }
    let before = points.to_vec();
    let mut normals = Vec::with_capacity(points.len());
    for (point, (sum, count)) in points.iter_mut().zip(sums) {
        let normal = body.sample(*point).gradient.normalize();
        let move_by = 0.5 * (sum / f64::max(count, 1.0) - *point);
        *point = project(body, *point + move_by - move_by.dot(normal) * normal, cell);
        normals.push(body.sample(*point).gradient.normalize());
    }
    let moved = points.to_vec();
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| moved[i]);
        let facing = (b - a).cross(c - a).normalize_or_zero();
        if corners.iter().any(|&i| facing.dot(normals[i]) < FOLDED) {
            corners.iter().for_each(|&i| points[i] = before[i]);
        }
    }
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
