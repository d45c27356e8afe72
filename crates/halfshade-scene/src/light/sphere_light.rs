//! A local light: a sphere of constant radiance.

use crate::Pose;
use glam::Vec3;

/// A spherical area light. It emits, but blocks nothing: lights are no geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereLight {
    /// Centre in world space.
    pub center: Vec3,
    /// Radius in metres, positive.
    pub radius: f32,
    /// Emitted radiance, the same from every point in every direction.
    pub radiance: Vec3,
}

impl SphereLight {
    /// The light, moved by a pose.
    pub fn moved(&self, pose: &Pose) -> Self {
        Self { center: pose.transform_point(self.center), radius: pose.scale * self.radius, ..*self }
    }

    /// Irradiance at `position` on a surface of unit `normal` if nothing blocks: exact, cut by the horizon. A point inside
    /// the light sees it all around.
    pub fn irradiance(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let offset = (self.center - position).as_dvec3();
        let (distance, radius) = (offset.length(), f64::from(self.radius));
        let form = if distance <= radius {
            std::f64::consts::PI
        } else {
            super::cap_irradiance(offset.dot(normal.as_dvec3()) / distance, radius / distance)
        };
        self.radiance * form as f32
    }
}
