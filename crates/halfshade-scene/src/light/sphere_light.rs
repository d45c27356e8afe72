//! A local light: a sphere of constant radiance.

use crate::Pose;
use glam::Vec3;
use serde::Serialize;

/// A spherical area light. It emits, but blocks nothing: lights are no geometry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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

    /// Irradiance at `position` on a surface of unit `normal` if nothing blocks: exact, cut by the horizon. A point
    /// inside the light sees it all around.
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn a_distant_light_obeys_the_inverse_square_and_a_surrounding_one_fills_the_sky() {
        let light = SphereLight { center: Vec3::new(0.0, 4.0, 3.0), radius: 0.5, radiance: Vec3::new(1.0, 2.0, 0.0) };
        let expected = PI * 0.25 / 25.0 * 0.8;
        assert!(light.irradiance(Vec3::ZERO, Vec3::Y).distance(expected * light.radiance) < 1e-6);
        assert_eq!(light.irradiance(Vec3::ZERO, Vec3::NEG_Y), Vec3::ZERO);
        assert!(light.irradiance(light.center, Vec3::X).distance(PI * light.radiance) < 1e-5);
        // On its surface, facing it: everything seen is the light.
        let touching = light.irradiance(light.center - 0.5 * Vec3::Y, Vec3::Y);
        assert!(touching.distance(PI * light.radiance) < 1e-3);
    }
}
