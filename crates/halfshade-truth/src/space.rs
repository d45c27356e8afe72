//! The space rays are traced in: the scene resized, and recentred where it lies far from the origin, without rounding.

use glam::{DVec3, Vec3, Vec3A};

/// No coordinate of a scene's box lies farther from its middle, in tracing space. obvhs drops what lies nearer than
/// 1e-4 to a ray's origin (fixed in its nodes): at this size that is 1e-13 of half the extent, below every offset here.
const HALF_EXTENT: f64 = (1_u64 << 30) as f64;

/// Largest distance of a receiver's coordinate from its surface, as a part of the coordinate: eight times half a unit
/// in the last place. Rounding of the receiver and that of the ray's origin take one each.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Added to that: receivers at coordinate 0 are exact, but the distance to a plane is found in double precision
/// only. 2^-46 of half the scene's extent.
const LEAST_ROUNDING: f64 = HALF_EXTENT / (1_u64 << 46) as f64;

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
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        if !(half.is_finite() && half.min_element() >= 0.0) {
            return Self { center_in_world: DVec3::ZERO, tracing_from_world: 1.0 };
        }
        // The difference of two numbers within a factor of two of each other is exact. The middle itself is rounded to a
        // number like theirs.
        let shift = |axis: usize| if center[axis].abs() >= 2.0 * half[axis] { center[axis] as f32 } else { 0.0 };
        let farthest = min.abs().max(max.abs()).max_element();
        let tracing_from_world = match half.max_element().max(LEAST_EXTENT * farthest) {
            0.0 => 1.0,
            half => (HALF_EXTENT / half).log2().floor().exp2(),
        };
        Self { center_in_world: Vec3::from_array(std::array::from_fn(shift)).as_dvec3(), tracing_from_world }
    }

    /// A point of the world, in tracing space.
    #[inline]
    pub(crate) fn point(&self, point_in_world: DVec3) -> Vec3A {
        self.exact_point(point_in_world).as_vec3a()
    }

    /// A point of tracing space, in the world.
    pub(crate) fn point_in_world(&self, point: Vec3A) -> DVec3 {
        point.as_dvec3() / self.tracing_from_world + self.center_in_world
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

    /// By how much the box around points of the world, `min` to `max`, grows on every side, in tracing space, so that
    /// rounding in the slab test loses no triangle.
    ///
    /// A few units in the last place of the largest coordinate, but no more than a part of the box itself: rays that
    /// start so far away that this is too little see it under a ten-millionth of a radian. And no less than receivers
    /// on the triangle may lie beside it.
    pub(crate) fn padding(&self, min: Vec3, max: Vec3) -> Vec3A {
        let size = self.length(f64::from((max - min).max_element()));
        let slabs = (4.0 * f64::from(f32::EPSILON) * HALF_EXTENT).min(size / 32.0);
        (2.0 * self.rounding(min.abs().max(max.abs()))).max(DVec3::splat(slabs)).as_vec3a()
    }

    /// Distance of a receiver from its surface along each axis, at most, in tracing space.
    ///
    /// Vertices are exact. Points between them were rounded to single precision in the world, and the origins of their
    /// rays once more. Nothing here knows the size of the scene: an object on a large ground shades it as on a small
    /// one.
    pub(crate) fn rounding(&self, point_in_world: Vec3) -> DVec3 {
        self.length(ROUNDING) * point_in_world.abs().as_dvec3() + LEAST_ROUNDING
    }

    /// The radius around the origin of tracing space within which the scene lies, with some room: no coordinate exceeds
    /// three half extents.
    pub(crate) fn bounding_radius() -> f64 {
        5.25 * HALF_EXTENT
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
                let traced = space.point(point.as_dvec3());
                assert_eq!(space.point_in_world(traced).as_vec3(), point);
                assert!(f64::from(traced.length()) < TracingSpace::bounding_radius(), "{point}");
            }
        }
    }

    /// Areas of boxes, times the number of triangles, are what hierarchies are built by.
    #[test]
    fn areas_of_padded_boxes_are_finite_however_far_out_and_small() {
        for far in [0.0, 1.0, 1e12, 1e28, 1e37, 3e38] {
            for half in [0.0, 1e-44, 1e-30, 1.0, 1e30] {
                let (min, max) = (Vec3::new(far, -half, -half), Vec3::new(far, half, half));
                let space = TracingSpace::around(min.as_dvec3(), max.as_dvec3());
                let size = (space.point(max.as_dvec3()) - space.point(min.as_dvec3())) + 2.0 * space.padding(min, max);
                assert!((1e9 * size.length_squared()).is_finite(), "{far} {half}: {size}");
            }
        }
    }
}
