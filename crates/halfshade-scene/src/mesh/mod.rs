//! Triangle meshes in object space: loading, welding, repair, normals.

mod alpha_mask;
mod animation;
mod assemble;
mod colors;
mod corners;
mod cutout;
mod file_scene;
mod gltf;
mod load;
mod normals;
mod obj;
mod orient;
mod ply;
mod polygon;
mod repair;
mod topology;
mod unit_size;
mod weld;
mod winding;
mod words;

pub use alpha_mask::AlphaMask;
pub use animation::Animation;
pub(crate) use assemble::LARGEST_COORDINATE;
pub use colors::ColorEncoding;
pub(crate) use file_scene::{FileScene, Punctual, PunctualKind};
pub use load::{EXTENSIONS, load, load_animated, load_animated_with_notes, load_with_colors, load_with_notes, parse};
pub(crate) use load::{load_scene, sound};
pub use normals::smooth_normals;
pub use repair::repaired;
pub use topology::{Body, Topology};
pub use weld::{Welded, weld};
pub(crate) use winding::winding;

use crate::Texture;
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A triangle mesh with a normal per vertex.
///
/// Triangles wind counter-clockwise seen from outside. Every vertex is a receiver.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per position.
    pub normals: Vec<Vec3>,
    /// Vertex colours that multiply the albedo, in [0, 1]; empty, or one per position.
    pub colors: Vec<Vec3>,
    /// Texture coordinates, finite: u to the right, v downward from the picture's top left corner, and the number of the
    /// texture in `textures`, the same at the three corners of a triangle. Empty, or one per position.
    pub texture_coordinates: Vec<Vec3>,
    /// Textures that multiply the albedo; empty, or all that `texture_coordinates` name.
    pub textures: Vec<Arc<Texture>>,
    /// Vertex indices of each triangle, each below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Masks that cut holes into triangles; empty, or all that `coverage` names.
    pub masks: Vec<AlphaMask>,
    /// Alpha of vertices, in [0, 1], and the number of their mask, the same at the three corners of a triangle; a number
    /// that masks don't have stands for none. Empty, or one per position.
    pub coverage: Vec<Vec2>,
}

impl Mesh {
    /// Smallest and largest coordinates over all vertices; `None` for a mesh without any.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        bounds(&self.positions)
    }

    /// Values of vertices, one each, interpolated at the point of a triangle that has these weights of its vertices.
    pub fn interpolated(&self, values: &[Vec3], triangle: usize, weights: DVec3) -> DVec3 {
        let [a, b, c] = self.triangles[triangle].map(|vertex| values[vertex as usize].as_dvec3());
        weights.x * a + weights.y * b + weights.z * c
    }
}

/// Smallest and largest coordinates over all points; `None` where there are none.
pub fn bounds(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(min, max), p| (min.min(*p), max.max(*p))))
}

/// Twice the area of a triangle times its unit normal, in f64.
///
/// The product of two f32 differences is exact in f64 to about 1e-16 of itself: slivers keep their direction.
fn doubled_area_vector([a, b, c]: [Vec3; 3]) -> glam::DVec3 {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a)
}
