//! Daylight of the built-in scenes.

use crate::Environment;
use crate::light::{EnvironmentMap, Sun};
use glam::Vec3;

/// A clear sky with a sun at `elevation` degrees above the horizon and `azimuth` degrees from -Z toward +X.
pub(super) fn clear_sky(elevation: f32, azimuth: f32) -> Environment {
    let (sin_e, cos_e) = elevation.to_radians().sin_cos();
    let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
    let direction = Vec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a).normalize();
    let texels = (0..64)
        .map(|row| 90.0 - (row as f32 + 0.5) / 64.0 * 180.0)
        .flat_map(|e: f32| {
            let horizon = Vec3::new(0.9, 0.95, 1.0);
            let zenith = Vec3::new(0.25, 0.45, 0.95);
            let t = (e / 90.0).max(0.0).sqrt();
            let c = if e < 0.0 { Vec3::splat(0.3) } else { horizon.lerp(zenith, t) };
            std::iter::repeat_n(c, 128)
        })
        .collect();
    let mut environment =
        EnvironmentMap::new(128, 64, texels).map_or(Environment::constant(Vec3::ONE), Environment::map);
    environment.sun = Some(Sun { direction, angular_radius: 0.00465, radiance: Vec3::new(1.0, 0.93, 0.8) * 3.0e4 });
    environment
}
