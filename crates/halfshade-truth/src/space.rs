//! The space rays are traced in: the scene recentred and resized, so that single precision is spent on the scene alone.

use glam::{DVec3, Vec3A};

/// Half the largest extent of the scene, in tracing space. obvhs drops what lies nearer than 1e-4 to a ray's origin
/// (fixed in its nodes); at this size that is less than the spacing of single-precision numbers.
const HALF_EXTENT: f64 = 1000.0;

/// A uniform scale and a shift between world space and tracing space. Directions are the same in both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TracingSpace {
    center_in_world: DVec3,
    tracing_from_world: f64,
    largest_world_coordinate: f64,
}

impl TracingSpace {
    /// The space around a box in world space; any space serves for an empty box.
    pub(crate) fn around(min: DVec3, max: DVec3) -> Self {
        let half_extent = 0.5 * (max - min).max_element();
        if !(half_extent.is_finite() && half_extent > 0.0) {
            let center_in_world =
                if min.is_finite() && max.is_finite() && min.cmple(max).all() { min } else { DVec3::ZERO };
            return Self {
                center_in_world,
                tracing_from_world: 1.0,
                largest_world_coordinate: center_in_world.abs().max_element(),
            };
        }
        Self {
            center_in_world: 0.5 * (min + max),
            tracing_from_world: HALF_EXTENT / half_extent,
            largest_world_coordinate: min.abs().max(max.abs()).max_element(),
        }
    }

    /// A point of the world, in tracing space.
    #[inline]
    pub(crate) fn point(&self, point_in_world: DVec3) -> Vec3A {
        ((point_in_world - self.center_in_world) * self.tracing_from_world).as_vec3a()
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

    /// By how much boxes grow on every side, so that rounding in the slab test loses no triangle: a few units in the
    /// last place of the largest coordinate.
    pub(crate) fn padding(&self) -> f32 {
        4.0 * f32::EPSILON * HALF_EXTENT as f32
    }

    /// How far above the surface rays start, in tracing space.
    ///
    /// Two roundings have to be passed: that of positions in tracing space and in the triangle test, a few units in the
    /// last place of the scene's size (1e-6 of half its extent is sixteen), and that of positions in world space, where
    /// receivers and vertices were rounded alike but interpolated points were not (four units in the last place of the
    /// largest world coordinate, which matters far from the origin only).
    pub(crate) fn surface_offset(&self) -> f32 {
        let world_rounding = 0.5 * f64::from(f32::EPSILON) * self.largest_world_coordinate;
        (1e-6 * HALF_EXTENT + 4.0 * self.length(world_rounding)) as f32
    }

    /// The scene's bounding sphere is centred at the origin of tracing space; this is its radius, with some room.
    pub(crate) fn bounding_radius() -> f64 {
        1.75 * HALF_EXTENT
    }

    /// A point of the world in tracing space, unrounded.
    pub(crate) fn exact_point(&self, point_in_world: DVec3) -> DVec3 {
        (point_in_world - self.center_in_world) * self.tracing_from_world
    }
}
