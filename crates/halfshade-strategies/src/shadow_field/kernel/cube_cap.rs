//! A cap of directions on the texels of a cube, its edge as wide as two texels.

use glam::Vec3;
use std::f32::consts::TAU;

/// A cap of directions.
pub(crate) struct CubeCap {
    axis: Vec3,
    /// Cosines where coverage begins and where it is whole.
    from: f32,
    whole: f32,
    solid_angle: f32,
}

impl CubeCap {
    /// All directions.
    pub(crate) const ALL: Self = Self { axis: Vec3::Y, from: -3.0, whole: -2.0, solid_angle: 2.0 * TAU };

    /// The cap of an angular radius in radians on a cube with `side` texels along an edge.
    pub(crate) fn new(side: usize, axis: Vec3, angular_radius: f32) -> Self {
        // As wide as a texel in the middle of a face: at least one of them is met, and the axis is kept.
        let texel = 2.0 / side as f32;
        Self {
            axis,
            from: (angular_radius + texel).min(std::f32::consts::PI).cos(),
            whole: (angular_radius - texel).max(0.0).cos(),
            solid_angle: 2.0 * TAU * (0.5 * angular_radius).sin().powi(2),
        }
    }

    /// How much of a texel in this direction it covers, about.
    #[inline(always)]
    pub(crate) fn coverage(&self, direction: Vec3) -> f32 {
        ((direction.dot(self.axis) - self.from) / (self.whole - self.from)).clamp(0.0, 1.0)
    }

    /// Solid angle in steradian.
    pub(crate) fn solid_angle(&self) -> f32 {
        self.solid_angle
    }

    /// The factor of coverages for which their sum is the cap's solid angle exactly.
    pub(crate) fn scale(&self, directions: &[Vec3], solid_angles: &[f32]) -> f32 {
        let covered = |(direction, solid_angle): (&Vec3, &f32)| self.coverage(*direction) * solid_angle;
        let sum: f32 = directions.iter().zip(solid_angles).map(covered).sum();
        if sum > 0.0 { self.solid_angle / sum } else { 0.0 }
    }
}
