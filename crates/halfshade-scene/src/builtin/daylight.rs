//! Daylight of the built-in scenes: the analytic clear sky with its sun, exposed so that white reflects about 1.

use crate::{Environment, light::Sky};

/// Full daylight on white is a radiance of about 2.5 in the sky's units.
const EXPOSURE: f32 = 0.4;

/// A clear sky with a sun at `elevation` degrees above the horizon and `azimuth` degrees from -Z toward +X.
pub(super) fn clear_sky(elevation: f32, azimuth: f32) -> Environment {
    Sky { sun_elevation_degrees: elevation, sun_azimuth_degrees: azimuth, ..Sky::default() }
        .environment()
        .expect("the suns of the built-in scenes stand above the horizon")
        .scaled(EXPOSURE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{DistantLight, luminance};
    use glam::Vec3;

    #[test]
    fn white_ground_reflects_about_one() {
        let light = clear_sky(40.0, 10.0);
        let DistantLight::Map(map) = &light.base else { panic!("no map") };
        let mut irradiance = Vec3::ZERO;
        for row in 0..map.height() {
            for column in 0..map.width() {
                let direction = map.texel_direction(row * map.width() + column);
                irradiance += map.radiance(direction) * direction.y.max(0.0) * map.texel_solid_angle(row) as f32;
            }
        }
        let sun = light.sun.unwrap();
        irradiance += sun.radiance * std::f32::consts::PI * sun.angular_radius.sin().powi(2) * sun.direction.y;
        let reflected = luminance(irradiance) / std::f32::consts::PI;
        assert!((0.7..1.3).contains(&reflected), "{reflected}");
    }
}
