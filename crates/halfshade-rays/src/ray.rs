//! A ray, in double precision.

use glam::DVec3;

/// How far behind its origin a ray meets what faces it, in lengths of its slack.
const REACH_BEHIND: f64 = 4.0;

/// A ray from a point along a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    pub(crate) origin: DVec3,
    /// Unit length.
    pub(crate) direction: DVec3,
    /// Distance from which on nothing is met.
    pub(crate) limit: f64,
    /// How far along each axis the surface that the origin stands for may lie beside it.
    pub(crate) slack: DVec3,
    /// How far behind its origin it meets what faces it.
    pub(crate) reach: f64,
}

impl Ray {
    /// A ray in free space, however long; `direction` has unit length.
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, limit: f64::INFINITY, slack: DVec3::ZERO, reach: 0.0 }
    }

    /// The same, shorter than `limit`.
    #[inline]
    pub fn until(self, limit: f64) -> Self {
        Self { limit, ..self }
    }

    /// The same from a surface with unit `normal` that lies within `slack` along each axis of where it is taken to be, the
    /// origin having been lifted by twice as much along the normal: it meets triangles that face it up to that far behind its
    /// origin, and doesn't meet those that face away until that far ahead, as measured along their normals.
    ///
    /// A point at the foot of a wall lies in the plane of the ground: rays that start there and go down cross the ground at
    /// distance 0 and must not escape below, while those that go up must not be blocked by it. Triangles farther behind than
    /// half the lift may be below the surface on which the ray starts: at an edge it would meet the side that it has just left.
    #[inline]
    pub fn leaving(self, normal: DVec3, slack: DVec3) -> Self {
        let off = normal.abs().dot(slack);
        let leaves = self.direction.dot(normal).max(f64::from(f32::MIN_POSITIVE));
        Self { slack, reach: (REACH_BEHIND * slack.max_element()).min(off / leaves), ..self }
    }
}
