//! Sphere sets: the geometry that blocks, in place of a mesh ([Guerrero2007, 4.1], [Wang2006]).

mod adjust;

pub use adjust::{AdjustRule, AdjustedSphere, FADE_HEIGHT, adjust, adjusted};

use glam::Vec3;

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

/// A set of spheres that bounds a mesh: every point of the surface lies in at least one of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SphereSet {
    /// The leaf spheres, in the mesh's own coordinates.
    pub spheres: Vec<Sphere>,
    /// Volume of the union of the spheres outside the mesh, as a fraction of the mesh's volume.
    pub outside_volume_fraction: f64,
    /// Largest distance by which a surface point lies outside every sphere; 0 for a set that bounds.
    pub bounding_violation: f64,
    /// By how much radii had to grow, after optimization over samples, so that the triangles are bounded: the largest
    /// growth as a fraction of the mesh's bounding-box diagonal.
    pub growth: f64,
}
