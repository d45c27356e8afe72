//! The space rays are traced in: the scene with half extents near 1, and recentred where it lies far from the origin, without
//! rounding.

use glam::{DVec3, Vec3};
use halfshade_rays::origin_between;

/// Largest distance of a receiver's coordinate from its surface, as a part of the coordinate: eight times half a unit
/// in the last place. Rounding of the receiver and that of the ray's origin take one each.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Added to that: receivers at coordinate 0 are exact, but the distance to a plane is found in double precision
/// only. 2^-46 of half the scene's extent.
const LEAST_ROUNDING: f64 = 1.0 / (1_u64 << 46) as f64;

/// The least half extent of a box, as a part of how far out it lies: boxes that are flat along the axes on which they lie
/// far out may be smaller by any factor, and what is added for rounding would overflow. 2^-32.
const LEAST_EXTENT: f64 = 1.0 / (1_u64 << 32) as f64;

/// A uniform scale and a shift between world space and tracing space. Directions are the same in both.
///
/// The scale is a power of two, and an axis is shifted only where that costs no digit: single-precision coordinates of
/// the scene are the same numbers in both spaces, however large the scene is beside its details.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TracingSpace {
    center_in_world: DVec3,
    tracing_from_world: f64,
}

impl TracingSpace {
    /// The space around a box in world space; any space serves for an empty box.
    pub(crate) fn around(min: DVec3, max: DVec3) -> Self {
        let half = 0.5 * (max - min);
        if !(half.is_finite() && half.min_element() >= 0.0) {
            return Self { center_in_world: DVec3::ZERO, tracing_from_world: 1.0 };
        }
        let farthest = min.abs().max(max.abs()).max_element();
        let tracing_from_world = match half.max_element().max(LEAST_EXTENT * farthest) {
            0.0 => 1.0,
            half => half.recip().log2().floor().exp2(),
        };
        Self { center_in_world: origin_between(min, max), tracing_from_world }
    }

    /// A point of tracing space, in the world.
    pub(crate) fn point_in_world(&self, point: DVec3) -> DVec3 {
        point / self.tracing_from_world + self.center_in_world
    }

    /// A length of the world, in tracing space.
    #[inline]
    pub(crate) fn length(&self, length_in_world: f64) -> f64 {
        length_in_world * self.tracing_from_world
    }

    /// A length of tracing space, in the world.
    #[inline]
    pub(crate) fn length_in_world(&self, length: f64) -> f64 {
        length / self.tracing_from_world
    }

    /// Distance of a receiver from its surface along each axis, at most, in tracing space.
    ///
    /// Vertices are exact. Points between them were rounded to single precision in the world, and the origins of their
    /// rays once more. Nothing here knows the size of the scene: an object on a large ground shades it as on a small
    /// one.
    pub(crate) fn rounding(&self, point_in_world: Vec3) -> DVec3 {
        self.length(ROUNDING) * point_in_world.abs().as_dvec3() + LEAST_ROUNDING
    }

    /// A point of the world in tracing space, unrounded.
    pub(crate) fn exact_point(&self, point_in_world: DVec3) -> DVec3 {
        (point_in_world - self.center_in_world) * self.tracing_from_world
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Every number of single precision in the box comes back as it was, wherever the box lies.
    #[test]
    fn coordinates_of_the_scene_are_not_rounded() {
        let boxes = [
            (Vec3::splat(-1e5), Vec3::splat(1e5)),
            (Vec3::new(-3.0, 0.0, 1.0), Vec3::new(2.0, 0.1, 1.2)),
            (Vec3::new(7e4, 0.0, -3e4), Vec3::new(7.1e4, 1e-6, -2.9e4)),
            (Vec3::new(1.0, 5.0, -3.3), Vec3::new(9.0, 5.0, -3.2)),
            (Vec3::splat(-1e-30), Vec3::splat(3e-30)),
            (Vec3::splat(-1e30), Vec3::splat(1e37)),
        ];
        for (min, max) in boxes {
            let space = TracingSpace::around(min.as_dvec3(), max.as_dvec3());
            let mut random = Pcg64Mcg::seed_from_u64(1);
            for _ in 0..1000 {
                let point = min + (max - min) * Vec3::from_array(random.random());
                let traced = space.exact_point(point.as_dvec3()).as_vec3().as_dvec3();
                assert_eq!(space.point_in_world(traced).as_vec3(), point);
                assert!(traced.abs().max_element() <= 3.0, "{point}");
            }
        }
    }
}
