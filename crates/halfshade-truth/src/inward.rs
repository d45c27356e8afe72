//! Directions into the surface from vertices at the rim of a smooth patch.
//!
//! Where walls meet with split normals, a vertex lies in the planes of all of them, and rays that start there could pass
//! on either side. They belong to the patch whose normal the vertex carries, so they start a little inside that patch.

use glam::Vec3;
use halfshade_scene::Receivers;
use std::collections::HashMap;

/// Per vertex in world space, found by the bits of its position and normal: where its own triangles lie.
#[derive(Debug, Default)]
pub(crate) struct Inward(HashMap<[u32; 6], Vec3>);

fn key(position: Vec3, normal: Vec3) -> [u32; 6] {
    let [px, py, pz] = position.to_array().map(f32::to_bits);
    let [nx, ny, nz] = normal.to_array().map(f32::to_bits);
    [px, py, pz, nx, ny, nz]
}

impl Inward {
    /// Adds the vertices of a mesh, given as receivers in world space.
    pub(crate) fn add(&mut self, triangles: &[[u32; 3]], vertices: &Receivers<'_>) {
        let mut sums = vec![(Vec3::ZERO, 0.0_f32); vertices.len()];
        for triangle in triangles.iter().filter(|t| t.iter().all(|&v| (v as usize) < vertices.len())) {
            let corners = triangle.map(|v| vertices.position_at(v as usize));
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            for (&vertex, corner) in triangle.iter().zip(corners) {
                if let Some(direction) = (center - corner).try_normalize() {
                    let (sum, count) = &mut sums[vertex as usize];
                    *sum += direction;
                    *count += 1.0;
                }
            }
        }
        for (vertex, (sum, count)) in sums.into_iter().enumerate() {
            let mean = sum / count.max(1.0);
            // Around a vertex inside a patch directions cancel up to the unevenness of the triangles; only a rim is
            // one-sided.
            if mean.length() > 0.5 {
                self.0.insert(key(vertices.position_at(vertex), vertices.normal_at(vertex)), mean);
            }
        }
    }

    /// The direction into the patch for a receiver at a rim vertex, of length below 1; zero for any other receiver.
    pub(crate) fn at(&self, position: Vec3, normal: Vec3) -> Vec3 {
        self.0.get(&key(position, normal)).copied().unwrap_or(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::ReceiverBuffer;

    #[test]
    fn only_vertices_at_the_rim_lean() {
        // Four triangles around the origin in the square |x|, |z| ≤ 1.
        let mut vertices = ReceiverBuffer::default();
        for position in [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
            vertices.push(position, Vec3::Y, Vec3::ONE, 0);
        }
        let mut inward = Inward::default();
        inward.add(&[[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [0, 1, 9]], &vertices.view());
        assert_eq!(inward.at(Vec3::ZERO, Vec3::Y), Vec3::ZERO);
        assert!(inward.at(Vec3::X, Vec3::Y).x < -0.5 && inward.at(Vec3::X, Vec3::Y).y == 0.0);
        assert_eq!(inward.at(Vec3::X, Vec3::NEG_Y), Vec3::ZERO);
    }
}
