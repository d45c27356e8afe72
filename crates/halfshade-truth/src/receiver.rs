//! One receiver, made ready for sampling.

use crate::{directions::Axes, triangle::Slack};
use glam::{DVec3, Vec3A};

/// A receiver's frame, and where its rays start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receiver {
    /// Origin of rays, in tracing space.
    pub(crate) ray_origin: Vec3A,
    /// Distance of that from the surface, at most, in tracing space.
    pub(crate) slack: Slack,
    /// Position in world space.
    pub(crate) position: DVec3,
    /// Unit shading normal in world space.
    pub(crate) normal: DVec3,
    /// The same normal and its tangents.
    pub(crate) axes: Axes,
}

impl Receiver {
    pub(crate) fn new(ray_origin: Vec3A, position: DVec3, normal: DVec3) -> Self {
        Self { ray_origin, slack: Slack::NONE, position, normal, axes: Axes::around(normal) }
    }
}
