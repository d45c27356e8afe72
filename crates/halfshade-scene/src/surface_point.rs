//! Points on objects at which receivers lie: there, what is baked per vertex is interpolated, whoever baked it.

use crate::Mesh;

/// A point of an object's surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum SurfacePoint {
    /// A vertex of the mesh, seen from the side of its normal.
    Vertex(u32),
    /// A point of a triangle of the mesh.
    Triangle {
        /// Index in `mesh.triangles`.
        triangle: u32,
        /// Weights of its vertices, of sum 1.
        barycentric: [f32; 3],
        /// Whether the receiver's normal is the opposite of the vertices': what these know of their hemisphere says
        /// nothing there.
        from_behind: bool,
    },
    /// Nowhere on the mesh: nothing that is baked per vertex is known.
    #[default]
    Elsewhere,
}

/// Vertices of a mesh and their weights, of sum 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexWeights {
    vertices: [u32; 3],
    weights: [f32; 3],
}

impl SurfacePoint {
    /// The vertices between which the point lies; `None` elsewhere, and where the mesh has no such vertex or triangle.
    pub fn weights(&self, mesh: &Mesh) -> Option<VertexWeights> {
        let found = match *self {
            Self::Vertex(vertex) => VertexWeights { vertices: [vertex; 3], weights: [1.0, 0.0, 0.0] },
            Self::Triangle { triangle, barycentric, .. } => {
                VertexWeights { vertices: *mesh.triangles.get(triangle as usize)?, weights: barycentric }
            }
            Self::Elsewhere => return None,
        };
        found.vertices.iter().all(|&vertex| (vertex as usize) < mesh.positions.len()).then_some(found)
    }

    /// The same of a point whose normal is that of its vertices, so that what they know of their hemisphere holds.
    pub fn weights_in_front(&self, mesh: &Mesh) -> Option<VertexWeights> {
        if self.is_from_behind() { None } else { self.weights(mesh) }
    }

    /// Whether the receiver's normal is the opposite of the vertices'.
    pub fn is_from_behind(&self) -> bool {
        matches!(self, Self::Triangle { from_behind: true, .. })
    }
}

impl VertexWeights {
    /// The vertex with the largest weight: for what can't be interpolated.
    pub fn nearest(&self) -> usize {
        let heavier = |best: usize, k: usize| if self.weights[k] > self.weights[best] { k } else { best };
        self.vertices[(1..3).fold(0, heavier)] as usize
    }

    /// Vertices that count, with their weights.
    #[inline]
    pub fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        self.vertices.into_iter().map(|vertex| vertex as usize).zip(self.weights).filter(|(_, weight)| *weight != 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;
    use glam::Vec3;

    #[test]
    fn positions_between_vertices_come_back() {
        let mesh = shapes::plane(3);
        let at = |point: SurfacePoint| -> Vec3 {
            let weights = point.weights(&mesh).unwrap();
            weights.parts().map(|(vertex, weight)| weight * mesh.positions[vertex]).sum()
        };
        for vertex in 0..mesh.positions.len() {
            assert_eq!(at(SurfacePoint::Vertex(vertex as u32)), mesh.positions[vertex]);
        }
        let barycentric = [0.25, 0.5, 0.25];
        for (triangle, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
            let point = SurfacePoint::Triangle { triangle: triangle as u32, barycentric, from_behind: false };
            assert!(at(point).distance(0.25 * a + 0.5 * b + 0.25 * c) < 1e-6);
            assert_eq!(point.weights(&mesh).unwrap().nearest(), corners[1] as usize);
        }
    }

    #[test]
    fn what_is_not_there_has_no_vertices() {
        let mesh = shapes::plane(1);
        let of = |triangle, from_behind| SurfacePoint::Triangle { triangle, barycentric: [1.0, 0.0, 0.0], from_behind };
        let vertices = mesh.positions.len() as u32;
        for missing in [SurfacePoint::Elsewhere, SurfacePoint::Vertex(vertices), of(mesh.triangles.len() as u32, false)]
        {
            assert_eq!(missing.weights(&mesh), None, "{missing:?}");
            assert_eq!(missing.weights_in_front(&mesh), None, "{missing:?}");
        }
        assert!(of(0, true).weights(&mesh).is_some() && of(0, true).weights_in_front(&mesh).is_none());
        assert_eq!(of(0, false).weights(&mesh), of(0, false).weights_in_front(&mesh));
    }
}
