//! Where single precision is spent.

use crate::ray::Ray;
use glam::{DVec3, Vec3};

/// The least half extent of what is traced, as a part of how far out it lies: what is flat along the axes on which it lies
/// far out may be smaller by any factor, and what is added for rounding would overflow. 2^-32.
const LEAST_EXTENT: f64 = 1.0 / (1_u64 << 32) as f64;

/// The least half extent of all: 2^-92, so that scales fit single precision.
const SMALLEST_EXTENT: f64 = 1.0 / (1_u128 << 92) as f64;

/// An origin for what lies between two corners: along each axis the middle if the middle is at least twice as far from 0
/// as from either end, else 0.
///
/// Coordinates about it are nowhere larger than before, and differences of it and of single-precision coordinates within
/// the corners are exact. So nothing is lost, however far apart things are: one that is far away doesn't take the digits
/// of those that are near, and a scene that was moved as a whole gets its own back.
pub fn origin_between(low: DVec3, high: DVec3) -> DVec3 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let along = |axis: usize| if middle[axis].abs() >= 2.0 * half[axis] { middle[axis] as f32 } else { 0.0 };
    let origin = Vec3::from_array(std::array::from_fn(along));
    if origin.is_finite() { origin.as_dvec3() } else { DVec3::ZERO }
}

/// Radius around the origin of a [`Space`] within which all lies: no coordinate exceeds 3.
pub(crate) const BOUNDING_RADIUS: f64 = 5.25;

/// A space in which the largest half extent of something is between 1/2 and 1, and no coordinate of it beyond 3.
///
/// The scale is a power of two, and an axis is moved only where that costs no digit: single-precision coordinates are the
/// same numbers there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Space {
    center: DVec3,
    scale: f64,
}

impl Space {
    /// For what lies in a box, from its low to its high corner; any space serves for none.
    pub(crate) fn around(corners: Option<[Vec3; 2]>) -> Self {
        let [low, high] = corners.unwrap_or_default().map(Vec3::as_dvec3);
        let farthest = low.abs().max(high.abs()).max_element();
        let half = (0.5 * (high - low).max_element()).max(LEAST_EXTENT * farthest).max(SMALLEST_EXTENT);
        Self { center: origin_between(low, high), scale: half.recip().log2().floor().exp2() }
    }

    /// A point, placed.
    #[inline]
    pub(crate) fn place(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// A ray, placed and moved forward to within [`BOUNDING_RADIUS`] if it starts outside, and by how much it was moved; `None` if
    /// it misses what is there, or isn't finite, or has no direction.
    #[inline(always)]
    pub(crate) fn place_ray(&self, ray: &Ray) -> Option<(Ray, f64)> {
        let mut placed = Ray {
            origin: self.place(ray.origin),
            direction: ray.direction,
            limit: self.length(ray.limit),
            slack: ray.slack * self.scale,
            reach: self.length(ray.reach),
        };
        let mut skipped = 0.0;
        let squared_radius = BOUNDING_RADIUS * BOUNDING_RADIUS;
        if placed.origin.length_squared() > squared_radius {
            let along = -placed.origin.dot(ray.direction);
            let half_chord_squared = squared_radius - (placed.origin + along * ray.direction).length_squared();
            if !(along > 0.0 && half_chord_squared > 0.0) {
                return None;
            }
            skipped = along - half_chord_squared.sqrt();
            placed.origin += skipped * ray.direction;
            placed.limit -= skipped;
        }
        let is_ray = placed.origin.is_finite() && ray.direction.length_squared() > 0.0 && !placed.limit.is_nan();
        is_ray.then_some((placed, skipped))
    }

    /// A length, scaled.
    #[inline]
    pub(crate) fn length(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// A scaled length, as it was.
    #[inline]
    pub(crate) fn length_outside(&self, length: f64) -> f64 {
        length / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_larger_coordinates() {
        let between = |a, b| origin_between(DVec3::min(a, b), DVec3::max(a, b));
        let near = [DVec3::new(1e6 + 0.25, -1.0, 3.0), DVec3::new(1e6 - 0.5, 1.0, 3.0)];
        assert_eq!(between(near[0], near[1]), DVec3::new(999_999.875, 0.0, 3.0));
        let far = DVec3::new(1e8, 0.0, 3.0);
        assert_eq!(between(near[0] - DVec3::X * 1e6, far), DVec3::new(0.0, 0.0, 3.0));
        assert_eq!(between(far, far), far);
        assert_eq!(between(DVec3::splat(1e300), DVec3::splat(1.1e300)), DVec3::ZERO);
    }

    /// Every number of single precision in a box comes back as it was, wherever the box lies.
    #[test]
    fn coordinates_are_not_rounded() {
        let boxes = [
            (Vec3::splat(-1e5), Vec3::splat(1e5)),
            (Vec3::new(-3.0, 0.0, 1.0), Vec3::new(2.0, 0.1, 1.2)),
            (Vec3::new(7e4, 0.0, -3e4), Vec3::new(7.1e4, 1e-6, -2.9e4)),
            (Vec3::splat(-1e-27), Vec3::splat(3e-27)),
            (Vec3::splat(-1e30), Vec3::splat(1e37)),
        ];
        for (low, high) in boxes {
            let space = Space::around(Some([low, high]));
            for i in 0..1000 {
                let at = |k: i32| ((i * k) % 997) as f32 / 997.0;
                let point = low + (high - low) * Vec3::new(at(1), at(37), at(101));
                let placed = space.place(point.as_dvec3()).as_vec3();
                assert_eq!(placed.as_dvec3() / space.scale + space.center, point.as_dvec3(), "{point}");
                assert!(placed.abs().max_element() <= 3.0, "{point}");
            }
        }
    }
}
