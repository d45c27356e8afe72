//! Distant light, projected onto spherical harmonics: S_d [Tamura2006, figure 3].

use halfshade_scene::{Environment, light};
use halfshade_sh::{basis, lat_long, zonal};

/// Distant light, projected.
pub(crate) struct DistantLight {
    pub(crate) environment: Environment,
    /// Coefficient by coefficient, red, green, blue.
    pub(crate) coefficients: Vec<[f32; 3]>,
}

/// The light of an environment in so many bands.
pub(crate) fn distant_light(bands: usize, environment: &Environment) -> DistantLight {
    let count = bands * bands;
    let mut light: [Vec<f64>; 3] = match &environment.base {
        light::DistantLight::Constant(radiance) => {
            let one = basis::one(bands);
            radiance.to_array().map(|channel| one.iter().map(|value| f64::from(channel) * value).collect())
        }
        light::DistantLight::Map(map) => {
            let texels: Vec<[f32; 3]> = map.texels().iter().map(|texel| texel.to_array()).collect();
            lat_long::project(bands, map.width(), map.height(), &texels)
                .unwrap_or_else(|| std::array::from_fn(|_| vec![0.0; count]))
        }
    };
    if let Some(sun) = environment.sun {
        let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        let axis = sun.direction.as_dvec3().normalize().to_array();
        let cap = zonal::rotate_to_axis(&zonal::cap_from_versine(bands, versine), axis);
        for (channel, radiance) in light.iter_mut().zip(sun.radiance.to_array()) {
            channel.iter_mut().zip(&cap).for_each(|(sum, value)| *sum += f64::from(radiance) * value);
        }
    }
    let coefficients = (0..count).map(|i| std::array::from_fn(|channel| light[channel][i] as f32)).collect();
    DistantLight { environment: environment.clone(), coefficients }
}
