//! Distant light in spherical harmonics: `c_i = ∫ L(ω) y_i(ω) dω`, channel by channel.

use glam::DVec3;
use halfshade_scene::{Environment, light::DistantLight};
use halfshade_sh::{basis, lat_long, zonal};

/// SH vectors of `bands` bands, per channel, of an environment with its sun: over a map texel by texel
/// ([`lat_long::project`]), over the sun in closed form. Radiance times steradian.
pub fn project_environment(bands: usize, environment: &Environment) -> [Vec<f64>; 3] {
    let mut light = project_base(bands, &environment.base);
    if let Some(sun) = environment.sun {
        // 1 - cos θ without cancellation.
        let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        let axis = sun.direction.as_dvec3().normalize_or(DVec3::Y).to_array();
        let cap = zonal::rotate_to_axis(&zonal::cap_from_versine(bands, versine), axis);
        for (channel, radiance) in light.iter_mut().zip(sun.radiance.to_array()) {
            channel.iter_mut().zip(&cap).for_each(|(sum, value)| *sum += f64::from(radiance) * value);
        }
    }
    light
}

/// The same of an environment without its sun.
pub fn project_base(bands: usize, base: &DistantLight) -> [Vec<f64>; 3] {
    match base {
        DistantLight::Constant(radiance) => {
            let one = basis::one(bands);
            radiance.to_array().map(|channel| one.iter().map(|value| f64::from(channel) * value).collect())
        }
        DistantLight::Map(map) => {
            let texels: Vec<[f32; 3]> = map.texels().iter().map(|texel| texel.to_array()).collect();
            // A map has as many texels as its size says.
            lat_long::project(bands, map.width(), map.height(), &texels)
                .unwrap_or_else(|| [0; 3].map(|_| vec![0.0; basis::coefficient_count(bands)]))
        }
    }
}
