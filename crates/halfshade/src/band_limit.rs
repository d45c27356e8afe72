//! The environment as so many bands of spherical harmonics see it.

use glam::Vec3;
use halfshade_scene::{Environment, light::EnvironmentMap};
use halfshade_sh::basis;
use halfshade_strategies::projected_light::project_environment;

/// Size of the map that a band-limited environment is tabulated on: what it varies within a texel at 8 bands is below
/// 1 % of its amplitude, and averages out.
const WIDTH: usize = 256;
const HEIGHT: usize = 128;

/// The projection of `environment` onto `bands` bands, sun included, as a map. Its radiance may be negative: that is the
/// ringing of so few bands.
pub fn band_limit(environment: &Environment, bands: usize) -> Environment {
    let coefficients = project_environment(bands, environment);
    let Some(blank) = EnvironmentMap::new(WIDTH, HEIGHT, vec![Vec3::ZERO; WIDTH * HEIGHT]) else {
        return environment.clone();
    };
    let texels = (0..WIDTH * HEIGHT).map(|i| {
        let direction = blank.texel_direction(i).as_dvec3().normalize_or(glam::DVec3::Y);
        let values = basis::evaluate(bands, direction.to_array());
        Vec3::from(coefficients.each_ref().map(|channel| basis::dot(channel, &values) as f32))
    });
    EnvironmentMap::new(WIDTH, HEIGHT, texels.collect()).map_or_else(|| environment.clone(), Environment::map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::light::Sun;

    #[test]
    fn what_has_few_bands_already_stays() {
        // 1 + y/2 has two bands.
        let texels = (0..WIDTH * HEIGHT).map(|i| {
            let v = ((i / WIDTH) as f32 + 0.5) / HEIGHT as f32;
            Vec3::new(1.0, 2.0, 0.0) * (1.0 + 0.5 * (std::f32::consts::PI * v).cos())
        });
        let map = Environment::map(EnvironmentMap::new(WIDTH, HEIGHT, texels.collect()).unwrap());
        let limited = band_limit(&map, 4);
        for direction in [Vec3::Y, Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.48, 0.6, -0.64)] {
            let difference = limited.radiance(direction) - map.radiance(direction);
            assert!(difference.abs().max_element() < 2e-3, "{direction}: {difference}");
        }
    }

    #[test]
    fn one_band_is_the_mean_over_the_sphere_sun_included() {
        let sun = Sun { direction: Vec3::new(0.6, 0.8, 0.0), angular_radius: 0.1, radiance: Vec3::splat(1000.0) };
        let environment = Environment { sun: Some(sun), ..Environment::constant(Vec3::splat(0.25)) };
        let mean = 0.25 + 1000.0 * 0.5 * (1.0 - 0.1f32.cos());
        let limited = band_limit(&environment, 1);
        assert!(limited.sun.is_none());
        assert!((limited.radiance(Vec3::X) - Vec3::splat(mean)).abs().max_element() < 1e-4 * mean);
    }

    #[test]
    fn few_bands_ring_below_zero_opposite_a_sun() {
        let sun = Sun { direction: Vec3::Y, angular_radius: 0.1, radiance: Vec3::ONE };
        let limited = band_limit(&Environment { sun: Some(sun), ..Environment::constant(Vec3::ZERO) }, 4);
        // Bands 0 to 3 of a delta at angle π: Σ(2l+1)(-1)^l/(4π)·Ω = -4/(4π)·Ω.
        let solid_angle = std::f32::consts::TAU * (1.0 - 0.1f32.cos());
        let expected = -4.0 / (4.0 * std::f32::consts::PI) * solid_angle;
        let found = limited.radiance(Vec3::NEG_Y).x;
        assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
    }
}
