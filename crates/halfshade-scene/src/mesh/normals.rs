//! Vertex normals from triangles.

use super::{Welded, doubled_area_vector};
use glam::{DVec3, Vec3};

/// Smooth unit normals of a welded mesh, one per position: the mean of the normals of the triangles around it, weighted
/// by their angles there, so that how a face is cut into triangles doesn't matter (\[Thurmer1998\]).
///
/// Where the mean vanishes (or no triangle with an area touches), the normal is that of the largest triangle around,
/// else +Y.
pub fn smooth_normals(welded: &Welded) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; welded.positions.len()];
    let mut largest = vec![DVec3::ZERO; welded.positions.len()];
    for (t, triangle) in welded.triangles.iter().enumerate() {
        let corners = welded.corners(t);
        let area_vector = doubled_area_vector(corners);
        let Some(normal) = area_vector.try_normalize() else { continue };
        let corners = corners.map(Vec3::as_dvec3);
        for i in 0..3 {
            let (p, q, r) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
            // atan2 of cross and dot keeps all digits for slivers, where acos would not.
            let angle = (q - p).cross(r - p).length().atan2((q - p).dot(r - p));
            let vertex = triangle[i] as usize;
            sums[vertex] += angle * normal;
            if area_vector.length_squared() > largest[vertex].length_squared() {
                largest[vertex] = area_vector;
            }
        }
    }
    sums.into_iter()
        .zip(largest)
        .map(|(sum, largest)| {
            // Angles sum to at least some 1e-3 around a vertex of use; a sum near 0 is two sheets that cancel.
            let normal = if sum.length() > 1e-9 { sum } else { largest };
            normal.normalize_or(DVec3::Y).as_vec3()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;
    use crate::mesh::{Mesh, weld};

    #[test]
    fn a_cube_corner_points_along_its_diagonal_however_faces_are_cut() {
        let welded = weld(&shapes::box_mesh(1));
        for (position, normal) in welded.positions.iter().zip(smooth_normals(&welded)) {
            assert!(normal.distance(position.normalize()) < 1e-6, "{position} {normal}");
        }
    }

    #[test]
    fn sphere_normals_are_radial() {
        let welded = weld(&shapes::shape("sphere").unwrap());
        let worst = welded.positions.iter().zip(smooth_normals(&welded)).map(|(p, n)| n.distance(p.normalize()));
        assert!(worst.fold(0.0, f32::max) < 0.01);
    }

    #[test]
    fn a_doubled_sheet_still_gets_unit_normals() {
        let mut mesh = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], ..Mesh::default() };
        mesh.triangles = vec![[0, 1, 2], [0, 2, 1]];
        assert!(smooth_normals(&weld(&mesh)).iter().all(|normal| normal.distance(Vec3::Z) < 1e-6));
    }
}
