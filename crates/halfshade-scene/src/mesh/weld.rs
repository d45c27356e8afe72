//! Welding: one vertex per position, so that triangles which meet in space share indices.
//!
//! Loaders and shapes split vertices where a normal or a texture coordinate jumps. Edges, holes and bodies are
//! questions about the surface, not about such splits.

use super::Mesh;
use glam::Vec3;
use std::collections::HashMap;

/// A mesh reduced to its geometry: equal positions merged, collapsed triangles left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Welded {
    /// Distinct positions, in the order of first appearance.
    pub positions: Vec<Vec3>,
    /// Triangles over `positions`, with three different corners each, in the mesh's order.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, its index in the mesh.
    pub source_triangles: Vec<u32>,
    /// For each vertex of the mesh, its index in `positions`.
    pub vertex_of: Vec<u32>,
}

impl Welded {
    /// Corner positions of triangle `t`.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }
}

/// Merges vertices at equal positions (bit for bit, with -0 = 0); no tolerance, so that nothing real is closed or lost.
///
/// Triangles that thereby have two equal corners enclose nothing and are left out.
pub fn weld(mesh: &Mesh) -> Welded {
    let mut index_of: HashMap<[u32; 3], u32> = HashMap::with_capacity(mesh.positions.len());
    let mut welded = Welded::default();
    for position in &mesh.positions {
        let key = position_key(*position);
        let index = *index_of.entry(key).or_insert_with(|| {
            welded.positions.push(*position);
            welded.positions.len() as u32 - 1
        });
        welded.vertex_of.push(index);
    }
    for (source, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|v| welded.vertex_of[v as usize]);
        if a != b && b != c && c != a {
            welded.triangles.push([a, b, c]);
            welded.source_triangles.push(source as u32);
        }
    }
    welded
}

/// Key that equal positions share: their bits, except that -0 is 0.
pub(super) fn position_key(position: Vec3) -> [u32; 3] {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;

    #[test]
    fn a_box_of_split_faces_becomes_a_cube_of_lattice_points() {
        let n = 5;
        let welded = weld(&shapes::box_mesh(n));
        // Lattice points on the surface of an (n+1)³ grid.
        assert_eq!(welded.positions.len(), (n + 1).pow(3) - (n - 1).pow(3));
        assert_eq!(welded.triangles.len(), 12 * n * n);
    }

    #[test]
    fn zeros_of_both_signs_are_one_place_and_collapsed_triangles_go() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::new(-0.0, 0.0, -0.0), Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        let welded = weld(&mesh);
        assert_eq!((welded.positions.len(), &welded.triangles[..]), (3, &[[0, 1, 2]][..]));
        assert_eq!((&welded.source_triangles[..], &welded.vertex_of[..]), (&[1][..], &[0, 0, 1, 2][..]));
    }
}
