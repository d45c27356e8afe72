//! Bounds of an object in its own space.

use glam::{DVec3, Vec3};
use halfshade_scene::{Mesh, clusters::bounding_sphere};

/// A sphere that holds an object, in the object's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BoundingSphere {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

impl BoundingSphere {
    /// The bounding sphere of an object that has no extent.
    pub(crate) const NONE: Self = Self { center: Vec3::ZERO, radius: 0.0 };

    /// The bounding sphere of all triangles; `None` if there are none, or they have no extent.
    pub(crate) fn of_mesh(mesh: &Mesh) -> Option<Self> {
        let used = mesh.triangles.iter().flatten().map(|&vertex| mesh.positions[vertex as usize].as_dvec3());
        let points: Vec<DVec3> = used.filter(|point| point.is_finite()).collect();
        let (center, radius) = bounding_sphere(&points);
        let bounds = Self { center: center.as_vec3(), radius: radius as f32 };
        (!points.is_empty() && bounds.radius > 0.0 && bounds.radius.is_finite()).then_some(bounds)
    }
}

/// Directions that may meet a bounding sphere.
pub(crate) struct BoundingCone {
    axis: Vec3,
    least_cosine: f32,
}

impl BoundingCone {
    /// The cone from `point` around a sphere, wider by `margin` radians.
    pub(crate) fn new(bounds: BoundingSphere, point: Vec3, margin: f32) -> Self {
        let offset = bounds.center - point;
        let distance = offset.length();
        let least_cosine = if distance > bounds.radius {
            ((bounds.radius / distance).asin() + margin).min(std::f32::consts::PI).cos()
        } else {
            -2.0
        };
        Self { axis: offset.normalize_or(Vec3::Y), least_cosine }
    }

    /// Whether a unit direction may meet the sphere.
    pub(crate) fn holds(&self, direction: Vec3) -> bool {
        direction.dot(self.axis) >= self.least_cosine
    }
}
