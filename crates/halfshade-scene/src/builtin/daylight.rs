//! Daylight of the built-in scenes: the standard clear sky, and a sun.
//!
//! The sky's luminance is type 12 of the CIE standard general sky (ISO 15469), "standard clear, low turbidity":
//! `L(direction) ~ φ(Z) f(χ)`, `φ(Z) = 1 - exp(-0.32 / cos Z)`,
//! `f(χ) = 1 + 10 (exp(-3 χ) - exp(-3 π/2)) + 0.45 cos² χ`, Z the angle from the zenith and χ that from the sun. The
//! standard says nothing about colour: here it fades from white at the horizon to blue at the zenith.

use crate::Environment;
use crate::light::{EnvironmentMap, Sun};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

const WIDTH: usize = 128;
const HEIGHT: usize = 64;
/// Irradiance of a horizontal plane by the sky alone, the mean of the three channels.
const SKY_IRRADIANCE: f32 = 0.2 * PI;
/// Irradiance of a plane that faces the sun, by the sun alone: with the sun 40 degrees high, a horizontal plane gets
/// about four times the sky's from it, as on a clear day, and white reflects a radiance of about 1.
const SUN_IRRADIANCE: f32 = 1.15 * PI;
const SUN_COLOR: Vec3 = Vec3::new(1.08, 1.0, 0.87);
/// As seen from the earth.
const SUN_ANGULAR_RADIUS: f32 = 0.00465;
/// Radiance from below the horizon.
const GROUND_RADIANCE: Vec3 = Vec3::new(0.17, 0.16, 0.14);

/// A clear sky with a sun at `elevation` degrees above the horizon and `azimuth` degrees from -Z toward +X.
pub(super) fn clear_sky(elevation: f32, azimuth: f32) -> Environment {
    let (sin_elevation, cos_elevation) = elevation.to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
    let sun = Vec3::new(cos_elevation * sin_azimuth, sin_elevation, -cos_elevation * cos_azimuth).normalize();
    let unscaled = |row: usize, column: usize| {
        let (u, v) = ((column as f32 + 0.5) / WIDTH as f32, (row as f32 + 0.5) / HEIGHT as f32);
        sky(direction_at(u, v), sun)
    };
    let texels: Vec<Vec3> =
        (0..HEIGHT / 2).flat_map(|row| (0..WIDTH).map(move |column| unscaled(row, column))).collect();
    let irradiance: f32 = texels
        .chunks(WIDTH)
        .enumerate()
        .map(|(row, texels)| {
            // The integral of cos Z sin Z over the row, exactly.
            let edge = |row: usize| (PI * row as f32 / HEIGHT as f32).sin().powi(2);
            let weight = PI / WIDTH as f32 * (edge(row + 1) - edge(row));
            weight * texels.iter().map(|texel| texel.element_sum() / 3.0).sum::<f32>()
        })
        .sum();
    let scale = SKY_IRRADIANCE / irradiance;
    let ground = std::iter::repeat_n(GROUND_RADIANCE, WIDTH * (HEIGHT - HEIGHT / 2));
    let texels = texels.into_iter().map(|texel| scale * texel).chain(ground).collect();
    let map = EnvironmentMap::new(WIDTH, HEIGHT, texels);
    Environment {
        sun: Some(Sun {
            direction: sun,
            angular_radius: SUN_ANGULAR_RADIUS,
            radiance: SUN_COLOR * SUN_IRRADIANCE / (PI * SUN_ANGULAR_RADIUS.sin().powi(2)),
        }),
        ..map.map_or(Environment::constant(GROUND_RADIANCE), Environment::map)
    }
}

/// [`EnvironmentMap::direction_at`] before there is a map.
fn direction_at(u: f32, v: f32) -> Vec3 {
    let (sin_azimuth, cos_azimuth) = ((2.0 * u - 1.0) * PI).sin_cos();
    let (sin_polar, cos_polar) = (v * PI).sin_cos();
    Vec3::new(sin_polar * sin_azimuth, cos_polar, -sin_polar * cos_azimuth)
}

/// Radiance of the sky up to a factor, for a unit `direction` above the horizon.
fn sky(direction: Vec3, sun: Vec3) -> Vec3 {
    let height = direction.y.max(1e-3);
    let cos_from_sun = direction.dot(sun).clamp(-1.0, 1.0);
    let gradation = 1.0 - (-0.32 / height).exp();
    let indicatrix =
        1.0 + 10.0 * ((-3.0 * cos_from_sun.acos()).exp() - (-3.0 * FRAC_PI_2).exp()) + 0.45 * cos_from_sun.powi(2);
    let (horizon, zenith) = (Vec3::new(1.0, 1.0, 1.0), Vec3::new(0.55, 0.9, 1.55));
    gradation * indicatrix * horizon.lerp(zenith, height.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::DistantLight;

    #[test]
    fn the_sun_stands_where_it_should_and_the_sky_is_brightest_around_it() {
        for (elevation, azimuth) in [(42.0f32, -125.0f32), (33.0, -118.0), (20.0, 60.0)] {
            let light = clear_sky(elevation, azimuth);
            let sun = light.sun.unwrap();
            assert!((sun.direction.y.asin().to_degrees() - elevation).abs() < 1e-3);
            assert!((sun.direction.x.atan2(-sun.direction.z).to_degrees() - azimuth).abs() < 1e-3);
            let DistantLight::Map(map) = &light.base else { panic!("no map") };
            let brightest = (0..map.texels().len())
                .max_by(|&a, &b| map.texels()[a].element_sum().total_cmp(&map.texels()[b].element_sum()));
            let (row, column) = (brightest.unwrap() / WIDTH, brightest.unwrap() % WIDTH);
            let toward = map.direction_at((column as f32 + 0.5) / WIDTH as f32, (row as f32 + 0.5) / HEIGHT as f32);
            assert!(toward.angle_between(sun.direction) < 0.1);
        }
    }

    #[test]
    fn irradiances_are_as_stated() {
        let light = clear_sky(40.0, 10.0);
        let DistantLight::Map(map) = &light.base else { panic!("no map") };
        // Quadrature over solid angle, where the construction integrates over projected solid angle.
        let mut sky = 0.0;
        for row in 0..HEIGHT / 2 {
            for column in 0..WIDTH {
                let (u, v) = ((column as f32 + 0.5) / WIDTH as f32, (row as f32 + 0.5) / HEIGHT as f32);
                let direction = map.direction_at(u, v);
                let radiance = f64::from(map.radiance(direction).element_sum()) / 3.0;
                sky += radiance * f64::from(direction.y) * map.texel_solid_angle(row);
            }
        }
        assert!((sky / f64::from(SKY_IRRADIANCE) - 1.0).abs() < 1e-3, "{sky}");
        let sun = light.sun.unwrap();
        let horizontal = SUN_IRRADIANCE * sun.direction.y;
        assert!((3.0..5.0).contains(&(horizontal / SKY_IRRADIANCE)));
        let cap = std::f32::consts::TAU * (1.0 - f64::from(sun.angular_radius).cos()) as f32;
        assert!(((sun.radiance * cap).element_sum() / (3.0 * SUN_IRRADIANCE) - 0.983).abs() < 0.01);
    }
}
