//! A clear daylight sky with a sun: the analytic model of \[Preetham1999\], with its constants.

use super::{Environment, EnvironmentMap, Sun, cap_irradiance};
use crate::SceneError;
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Luminance in kcd/m² that becomes a radiance of 1: the zenith of a clear sky is then near 1, as scenes expect.
pub const KILOCANDELAS_PER_UNIT: f64 = 10.0;

/// Angular radius of the sun in radians.
pub(crate) const SUN_ANGULAR_RADIUS: f64 = 0.00465;

/// Illuminance of the sun above the atmosphere, in klx: the solar illuminance constant.
const SUN_KILOLUX: f64 = 133.3;

/// Wavelengths in µm that stand for red, green and blue light in the sun's extinction.
const WAVELENGTHS: [f64; 3] = [0.61, 0.55, 0.465];

/// A clear sky. Angles in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// Height of the sun above the horizon, in (0, 90].
    pub sun_elevation_degrees: f32,
    /// Direction of the sun around +Y: 0 is -Z, 90 is +X.
    pub sun_azimuth_degrees: f32,
    /// Haziness, in [1.7, 10]: 2 is very clear, 3 clear, 6 hazy. Below 2 the model's horizon gets too bright.
    pub turbidity: f32,
    /// Reflectance of the ground that is seen below the horizon, in [0, 1].
    pub ground_albedo: Vec3,
    /// Whether there is a sun; its light on the ground goes with it. The brightening around it belongs to the sky.
    pub sun: bool,
    /// Rows of the map, even, from 8 to 4096; it has twice as many columns.
    pub resolution: usize,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            sun_elevation_degrees: 45.0,
            sun_azimuth_degrees: 135.0,
            turbidity: 3.0,
            ground_albedo: Vec3::splat(0.2),
            sun: true,
            resolution: 128,
        }
    }
}

impl Sky {
    /// Unit direction toward the sun.
    pub fn sun_direction(&self) -> Vec3 {
        self.sun_direction_f64().as_vec3()
    }

    fn sun_direction_f64(&self) -> DVec3 {
        let (sin_elevation, cos_elevation) = f64::from(self.sun_elevation_degrees).to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = f64::from(self.sun_azimuth_degrees).to_radians().sin_cos();
        DVec3::new(cos_elevation * sin_azimuth, sin_elevation, -cos_elevation * cos_azimuth)
    }

    /// Error for parameters that no sky has.
    fn check(&self) -> Result<(), SceneError> {
        let wrong = |problem: String| Err(SceneError::new(problem));
        if !(self.sun_elevation_degrees > 0.0 && self.sun_elevation_degrees <= 90.0) {
            return wrong(format!("the sun's elevation is {}, outside (0, 90] degrees", self.sun_elevation_degrees));
        }
        if !self.sun_azimuth_degrees.is_finite() {
            return wrong("the sun's azimuth is not a finite number".to_owned());
        }
        if !(1.7..=10.0).contains(&self.turbidity) {
            return wrong(format!("the turbidity is {}, outside [1.7, 10]", self.turbidity));
        }
        if !(self.ground_albedo.min_element() >= 0.0 && self.ground_albedo.max_element() <= 1.0) {
            return wrong(format!("the ground's albedo is {}, outside [0, 1]", self.ground_albedo));
        }
        if !(8..=4096).contains(&self.resolution) || !self.resolution.is_multiple_of(2) {
            return wrong(format!("the sky's resolution is {}; it must be even, from 8 to 4096", self.resolution));
        }
        Ok(())
    }

    /// The sky as an environment: a map, and the sun apart from it.
    ///
    /// Below the horizon the map shows a diffuse ground: albedo/π times the irradiance of sky and sun.
    pub fn environment(&self) -> Result<Environment, SceneError> {
        self.check()?;
        let (width, height) = (2 * self.resolution, self.resolution);
        let mut map = EnvironmentMap::new(width, height, vec![Vec3::ZERO; width * height])
            .ok_or_else(|| SceneError::new("the sky's map has no texels"))?;
        let model = Model::new(self);
        let mut texels = Vec::with_capacity(width * height);
        let mut irradiance = DVec3::ZERO;
        for row in 0..height / 2 {
            // ∫ cosθ dω over the row's texels: the sum is then exact for a sky that is constant over each texel.
            let cosine = |row: usize| (PI * row as f64 / height as f64).cos();
            let weight = 0.5 * (cosine(row).powi(2) - cosine(row + 1).powi(2)) * 2.0 * PI / width as f64;
            for column in 0..width {
                let radiance = model.radiance(map.texel_direction(row * width + column).as_dvec3().normalize());
                irradiance += weight * radiance;
                texels.push(radiance.as_vec3());
            }
        }
        let sun = self.sun.then(|| Sun {
            direction: self.sun_direction(),
            angular_radius: SUN_ANGULAR_RADIUS as f32,
            radiance: model.sun_radiance().as_vec3(),
        });
        if sun.is_some() {
            let cap = cap_irradiance(model.sun.y, SUN_ANGULAR_RADIUS.sin());
            irradiance += cap * model.sun_radiance();
        }
        let ground = (self.ground_albedo.as_dvec3() / PI * irradiance).as_vec3();
        texels.resize(width * height, ground);
        map = EnvironmentMap::new(width, height, texels).unwrap_or(map);
        Ok(Environment { sun, ..Environment::map(map) })
    }
}

/// Perez's five coefficients, as (factor of the turbidity, constant): luminance Y, chromaticities x and y.
const PEREZ: [[(f64, f64); 5]; 3] = [
    [(0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)],
    [(-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)],
    [(-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)],
];

/// Zenith chromaticities x and y: rows by falling power of the turbidity, columns by falling power of the sun's angle.
const ZENITH: [[[f64; 4]; 3]; 2] = [
    [[0.00166, -0.00375, 0.00209, 0.0], [-0.02903, 0.06377, -0.03202, 0.00394], [0.11693, -0.21196, 0.06052, 0.25886]],
    [[0.00275, -0.00610, 0.00317, 0.0], [-0.04214, 0.08970, -0.04153, 0.00516], [0.15346, -0.26756, 0.06670, 0.26688]],
];

/// The model with its coefficients worked out for one sun and one turbidity.
struct Model {
    sun: DVec3,
    turbidity: f64,
    perez: [[f64; 5]; 3],
    /// Zenith luminance in kcd/m² and chromaticities, each over F(0, θ_sun).
    scale: [f64; 3],
}

impl Model {
    fn new(sky: &Sky) -> Self {
        let (sun, turbidity) = (sky.sun_direction_f64(), f64::from(sky.turbidity));
        let sun_angle = FRAC_PI_2 - f64::from(sky.sun_elevation_degrees).to_radians();
        let perez = PEREZ.map(|row| row.map(|(factor, constant)| factor * turbidity + constant));
        let chi = (4.0 / 9.0 - turbidity / 120.0) * (PI - 2.0 * sun_angle);
        let luminance = (4.0453 * turbidity - 4.9710) * chi.tan() - 0.2155 * turbidity + 2.4192;
        let powers = [sun_angle.powi(3), sun_angle.powi(2), sun_angle, 1.0];
        let chromaticity = ZENITH.map(|rows| {
            rows.iter().fold(0.0, |sum, row| sum * turbidity + row.iter().zip(powers).map(|(c, p)| c * p).sum::<f64>())
        });
        let zenith = [luminance, chromaticity[0], chromaticity[1]];
        let scale = [0, 1, 2].map(|i| zenith[i] / perez_function(&perez[i], 1.0, sun_angle));
        Self { sun, turbidity, perez, scale }
    }

    /// Radiance of the sky toward unit `direction`, at or above the horizon.
    fn radiance(&self, direction: DVec3) -> DVec3 {
        let angle_to_sun = direction.cross(self.sun).length().atan2(direction.dot(self.sun));
        let [luminance, x, y] =
            [0, 1, 2].map(|i| self.scale[i] * perez_function(&self.perez[i], direction.y.max(0.0), angle_to_sun));
        let luminance = luminance / KILOCANDELAS_PER_UNIT;
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance;
        // Colours outside of the gamut lose what they'd have below zero.
        (rec709_from_xyz() * xyz).max(DVec3::ZERO)
    }

    /// Radiance of the sun's disc: white above the atmosphere, dimmed by exp(-τ m) on its way down.
    ///
    /// Optical depths: Rayleigh 0.008735 λ^-4.08, aerosols β λ^-1.3 with β = 0.04608 T - 0.04586 ([Preetham1999,
    /// appendix]); air mass m after \[Kasten1989\]. Ozone is left out: 1 to 4 % of the visible light of a high sun.
    fn sun_radiance(&self) -> DVec3 {
        let zenith_degrees = self.sun.y.clamp(0.0, 1.0).acos().to_degrees();
        let air_mass = 1.0 / (self.sun.y.max(0.0) + 0.50572 * (96.07995 - zenith_degrees).powf(-1.6364));
        let beta = 0.04608 * self.turbidity - 0.04586;
        let depth = |wavelength: f64| 0.008735 * wavelength.powf(-4.08) + beta * wavelength.powf(-1.3);
        let transmitted = DVec3::from_array(WAVELENGTHS.map(|wavelength| (-air_mass * depth(wavelength)).exp()));
        SUN_KILOLUX / (PI * SUN_ANGULAR_RADIUS.sin().powi(2)) / KILOCANDELAS_PER_UNIT * transmitted
    }
}

/// F(θ, γ) = (1 + A e^(B/cosθ)) (1 + C e^(Dγ) + E cos²γ) ([Preetham1999, eq. 3], after Perez et al.).
fn perez_function(&[a, b, c, d, e]: &[f64; 5], cos_zenith: f64, angle_to_sun: f64) -> f64 {
    // B is negative for all turbidities allowed: the limit at the horizon is 1.
    let gradient = if cos_zenith > 0.0 { 1.0 + a * (b / cos_zenith).exp() } else { 1.0 };
    gradient * (1.0 + c * (d * angle_to_sun).exp() + e * angle_to_sun.cos().powi(2))
}

/// Linear Rec. 709 from CIE XYZ, white D65 (the matrix of IEC 61966-2-1).
fn rec709_from_xyz() -> DMat3 {
    DMat3::from_cols(
        DVec3::new(3.2404542, -0.9692660, 0.0556434),
        DVec3::new(-1.5371385, 1.8760108, -0.2040259),
        DVec3::new(-0.4985314, 0.0415560, 1.0572252),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{DistantLight, luminance};

    fn map(environment: &Environment) -> &EnvironmentMap {
        match &environment.base {
            DistantLight::Map(map) => map,
            DistantLight::Constant(_) => panic!("a sky is a map"),
        }
    }

    /// Irradiance of the sky on the ground: the midpoint rule in the square of the sine, away from the map's grid.
    fn sky_irradiance(sky: &Sky) -> DVec3 {
        let model = Model::new(sky);
        let (rings, sectors) = (300, 600);
        let mut sum = DVec3::ZERO;
        for i in 0..rings {
            let sine = ((i as f64 + 0.5) / rings as f64).sqrt();
            for j in 0..sectors {
                let azimuth = 2.0 * PI * (j as f64 + 0.3) / sectors as f64;
                let (z, x) = azimuth.sin_cos();
                sum += model.radiance(DVec3::new(sine * x, (1.0 - sine * sine).sqrt(), sine * z));
            }
        }
        sum * PI / (rings * sectors) as f64
    }

    #[test]
    fn the_ground_reflects_the_irradiance_of_sky_and_sun() {
        for sun in [false, true] {
            let sky = Sky { sun, ..Sky::default() };
            let environment = sky.environment().unwrap();
            let mut expected = sky_irradiance(&sky);
            if let Some(sun) = environment.sun {
                let solid_angle = 2.0 * PI * (1.0 - f64::from(sun.angular_radius).cos());
                expected += solid_angle * f64::from(sun.direction.y) * sun.radiance.as_dvec3();
            }
            let ground = environment.radiance(Vec3::new(0.1, -1.0, 0.0).normalize()).as_dvec3();
            assert!((ground * PI / 0.2 - expected).abs().max_element() < 3e-3 * expected.max_element(), "{sun}");
        }
    }

    #[test]
    fn every_radiance_is_finite_and_not_negative() {
        for turbidity in [1.7, 2.0, 3.0, 6.0, 10.0] {
            for elevation in [0.01, 1.0, 10.0, 45.0, 89.0, 90.0] {
                let sky = Sky { turbidity, sun_elevation_degrees: elevation, resolution: 32, ..Sky::default() };
                let environment = sky.environment().unwrap();
                let sun = environment.sun.unwrap();
                let values = map(&environment).texels().iter().chain([&sun.radiance]);
                for value in values {
                    assert!(value.is_finite() && value.min_element() >= 0.0, "{turbidity} {elevation}: {value}");
                }
                assert!(luminance(map(&environment).texels()[0]) > 0.0 && sun.direction.y >= 0.0);
            }
        }
    }

    #[test]
    fn the_zenith_has_the_luminance_the_model_gives_it() {
        // By hand, T = 3, sun at 45 degrees: χ = (4/9 - 3/120) π/2 = 0.65886, tan χ = 0.77447,
        // Y = (4.0453·3 - 4.9710)·0.77447 - 0.2155·3 + 2.4192 = 7.3219 kcd/m².
        let zenith = luminance(Model::new(&Sky::default()).radiance(DVec3::Y).as_vec3());
        assert!((f64::from(zenith) * KILOCANDELAS_PER_UNIT - 7.3219).abs() < 0.01, "{zenith}");
    }

    #[test]
    fn the_sun_stands_where_it_is_put_and_outshines_a_clear_sky() {
        let sky = Sky { sun_elevation_degrees: 60.0, sun_azimuth_degrees: 90.0, turbidity: 2.5, ..Sky::default() };
        let environment = sky.environment().unwrap();
        let sun = environment.sun.unwrap();
        assert!(sun.direction.distance(Vec3::new(0.5, 0.75_f32.sqrt(), 0.0)) < 1e-6);
        let from_sun = cap_irradiance(sun.direction.y.into(), f64::from(sun.angular_radius).sin());
        let from_sun = f64::from(luminance(sun.radiance)) * from_sun;
        let ratio = from_sun / f64::from(luminance(sky_irradiance(&sky).as_vec3()));
        assert!((3.0..10.0).contains(&ratio), "{ratio}");
        // The sky is bluest away from the sun, and a low sun is red.
        let away = environment.radiance(Vec3::new(-0.6, 0.8, 0.0));
        assert!(away.z > 1.2 * away.x, "{away}");
        let low = Sky { sun_elevation_degrees: 3.0, ..sky }.environment().unwrap().sun.unwrap().radiance;
        assert!(low.x > 3.0 * low.z && low.x < sun.radiance.x, "{low}");
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let sky = Sky::default();
        for bad in [
            Sky { sun_elevation_degrees: 0.0, ..sky },
            Sky { sun_elevation_degrees: f32::NAN, ..sky },
            Sky { turbidity: 1.0, ..sky },
            Sky { turbidity: 11.0, ..sky },
            Sky { ground_albedo: Vec3::splat(1.5), ..sky },
            Sky { resolution: 9, ..sky },
        ] {
            assert!(bad.environment().is_err(), "{bad:?}");
        }
    }
}
