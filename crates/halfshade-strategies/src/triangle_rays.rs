//! Triangles in a wide bounding-volume hierarchy, for rays that ask whether anything is in the way.

use glam::{Vec3, Vec3A};
use obvhs::{
    Boundable, BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::Ray,
    rt_triangle::RtTriangle,
};
use std::time::Duration;

/// Half the largest extent in the space that rays are traced in. obvhs ignores hits nearer than 1e-4, whatever the
/// size: here that is two units in the last place.
pub(crate) const HALF_EXTENT: f32 = 512.0;

/// The hierarchy over primitives, of which there may be none.
pub(crate) fn hierarchy<T: Boundable>(primitives: &[T]) -> CwBvh {
    if primitives.is_empty() {
        return CwBvh::default();
    }
    build_cwbvh(primitives, BvhBuildParams::medium_build(), &mut Duration::default())
}

/// Triangles, centred and scaled.
///
/// Not watertight: a ray aimed exactly at an edge may pass. Both faces of a triangle block.
pub(crate) struct TriangleRays {
    hierarchy: CwBvh,
    /// In the order of the hierarchy's leaves.
    triangles: Vec<RtTriangle>,
    center: Vec3,
    scale: f32,
    /// How much coordinates of the corners may be rounded, in units of the traced space.
    coarseness: f32,
}

impl TriangleRays {
    /// Of the triangles with these corners; what is not finite is left out.
    pub(crate) fn new(mut corners: Vec<[Vec3; 3]>) -> Self {
        corners.retain(|points| points.iter().all(|point| point.is_finite()));
        let low = corners.iter().flatten().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = corners.iter().flatten().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let center = low + 0.5 * (high - low);
        let half = 0.5 * (high - low).max_element();
        let scale = if half > 0.0 { (HALF_EXTENT / half).min(f32::MAX.sqrt()) } else { 1.0 };
        let place = |point: Vec3| Vec3A::from((point - center) * scale);
        let triangles: Vec<RtTriangle> =
            corners.iter().map(|&[a, b, c]| RtTriangle::new(place(a), place(b), place(c))).collect();
        let hierarchy = hierarchy(&triangles);
        let triangles = hierarchy.primitive_indices.iter().map(|&slot| triangles[slot as usize]).collect();
        let coarseness = low.abs().max(high.abs()).max_element() * f32::EPSILON * scale;
        Self { hierarchy, triangles, center, scale, coarseness }
    }

    /// How far, in units of the traced space, a point may be off because coordinates far from the origin are coarse.
    pub(crate) fn coarseness(&self) -> f32 {
        self.coarseness
    }

    /// Whether a triangle lies on the ray within `distance`, which may be infinite. The ray starts at `position`, moved by
    /// `lift` in the traced space, of which the triangles fill 1024 units. `direction` has unit length.
    pub(crate) fn blocked(&self, position: Vec3, lift: Vec3, direction: Vec3, distance: f32) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let origin = Vec3A::from((position - self.center) * self.scale + lift);
        let limit = distance * self.scale;
        if !origin.is_finite() || !direction.is_finite() || limit.is_nan() {
            return false;
        }
        // -0.0 would make the hierarchy miss everything.
        let ray = Ray::new(origin, Vec3A::from(direction) + 0.0, 0.0, limit);
        !self.hierarchy.ray_traverse_miss(ray, |ray, slot| self.triangles[slot].intersect(ray))
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.hierarchy.nodes.as_slice())
            + size_of_val(self.hierarchy.primitive_indices.as_slice())
    }
}
