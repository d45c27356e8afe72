//! Holes in a surface: where alpha is below a cutoff, there is none.

use super::{AlphaMask, Mesh};
use glam::{DVec2, DVec3};

impl Mesh {
    /// Whether any triangle may have holes.
    pub fn has_cutouts(&self) -> bool {
        !self.masks.is_empty()
    }

    /// The mask that cuts holes into a triangle.
    pub fn mask_of(&self, triangle: usize) -> Option<&AlphaMask> {
        if self.masks.is_empty() {
            return None;
        }
        let first = *self.triangles.get(triangle)?.first()?;
        self.masks.get(self.coverage.get(first as usize)?.y as usize)
    }

    /// Whether the point of a triangle that has these weights of its vertices lies in a hole.
    ///
    /// Alpha is that of the vertices, interpolated, times that of the mask's texture.
    pub fn is_cut_out(&self, triangle: usize, weights: DVec3) -> bool {
        let Some(mask) = self.mask_of(triangle) else { return false };
        let corners = self.triangles[triangle].map(|vertex| vertex as usize);
        let of_vertices: f64 =
            corners.iter().zip(weights.to_array()).map(|(&v, weight)| weight * f64::from(self.coverage[v].x)).sum();
        let of_texture = mask.texture.as_ref().map_or(1.0, |texture| {
            let place = if self.texture_coordinates.is_empty() {
                DVec2::ZERO
            } else {
                self.interpolated(&self.texture_coordinates, triangle, weights).truncate()
            };
            texture.at(place).x
        });
        (of_vertices * f64::from(of_texture)) < f64::from(mask.cutoff)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Texture;
    use glam::{Vec2, Vec3};
    use std::sync::Arc;

    #[test]
    fn alpha_of_vertices_and_texture_multiply() {
        // Alpha 1 left of the middle and .5 right of it, times 1 to 0 along z.
        let halves = Texture::new(2, 1, vec![Vec3::ONE, Vec3::splat(0.5)]).unwrap();
        let halves = halves.wrapped([crate::texture::Wrap::Clamp; 2]);
        let mask = AlphaMask { texture: Some(Arc::new(halves)), cutoff: 0.3 };
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
            texture_coordinates: vec![Vec3::ZERO, Vec3::X, Vec3::ZERO],
            triangles: vec![[0, 1, 2]],
            masks: vec![mask],
            coverage: vec![Vec2::X, Vec2::X, Vec2::ZERO],
            ..Mesh::default()
        };
        for (x, z, is_cut) in [(0.1, 0.6, false), (0.1, 0.8, true), (0.75, 0.1, false), (0.3, 0.69, true)] {
            let of_texture = if x < 0.25 {
                1.0
            } else if x > 0.75 {
                0.5
            } else {
                1.0 - (x - 0.25)
            };
            assert_eq!((1.0 - z) * of_texture < 0.3, is_cut, "the expectation for {x} {z}");
            assert_eq!(mesh.is_cut_out(0, DVec3::new(1.0 - x - z, x, z)), is_cut, "{x} {z}");
        }
        // A number that masks don't have stands for none.
        mesh.coverage.iter_mut().for_each(|c| c.y = 1.0);
        assert!(mesh.mask_of(0).is_none() && !mesh.is_cut_out(0, DVec3::Z));
    }
}
