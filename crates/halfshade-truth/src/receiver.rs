//! One receiver, made ready for sampling.

use crate::directions::Axes;
use glam::{DVec3, Vec3};
use halfshade_rays::Ray;

/// A receiver's frame, and where its rays start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receiver {
    /// Origin of rays, in tracing space.
    pub(crate) ray_origin: DVec3,
    /// Distance of that from the surface along each axis, at most, in tracing space; 0 in free space.
    pub(crate) slack: DVec3,
    /// Position in world space.
    pub(crate) position: DVec3,
    /// Unit shading normal in world space.
    pub(crate) normal: DVec3,
    /// The same normal and its tangents.
    pub(crate) axes: Axes,
}

impl Receiver {
    pub(crate) fn new(ray_origin: DVec3, position: DVec3, normal: DVec3) -> Self {
        Self { ray_origin, slack: DVec3::ZERO, position, normal, axes: Axes::around(normal) }
    }

    /// A ray that leaves it, shorter than `limit`, in tracing space.
    pub(crate) fn ray(&self, direction: Vec3, limit: f32) -> Ray {
        let ray = Ray::new(self.ray_origin, direction.as_dvec3()).until(f64::from(limit));
        ray.leaving(self.normal, self.slack)
    }
}
