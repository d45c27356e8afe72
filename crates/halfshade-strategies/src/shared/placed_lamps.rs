//! Lights of which a receiver sees a cap, where they are in a frame: local spheres, the sun, lamps of a map.

use glam::{DVec3, Vec3};
use halfshade_scene::{
    Frame, SphereLight,
    light::{Sun, cap_irradiance},
};

/// A place that shines, in light space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampPlace {
    /// Infinitely far away.
    Far {
        /// Unit direction to its middle.
        direction: [f32; 3],
        /// Sine of its angular radius.
        sine: f32,
    },
    /// A sphere.
    Near {
        /// Centre.
        center: [f32; 3],
        /// Radius.
        radius: f32,
    },
}

/// A light of which a cap is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// Where it is.
    pub place: LampPlace,
    /// Radiance of the cap.
    pub radiance: Vec3,
}

/// All lamps of a frame that aren't dark: its lights and these suns, which are in the environment's space.
pub(crate) fn placed_lamps(
    frame: &Frame<'_>,
    suns: impl Iterator<Item = Sun>,
    light_from_world: impl Fn(DVec3) -> Vec3,
) -> Vec<Lamp> {
    let near = frame.lights.iter().map(|light| Lamp {
        place: LampPlace::Near { center: light_from_world(light.center.as_dvec3()).to_array(), radius: light.radius },
        radiance: light.radiance,
    });
    let far = suns.map(|sun| Lamp::far(&sun));
    near.chain(far).filter(|lamp| lamp.radiance != Vec3::ZERO).collect()
}

impl Lamp {
    /// A sun.
    fn far(sun: &Sun) -> Self {
        let direction = sun.direction.as_dvec3().normalize_or(DVec3::Y).as_vec3().to_array();
        let sine = f64::from(sun.angular_radius).sin().clamp(0.0, 1.0) as f32;
        Self { place: LampPlace::Far { direction, sine }, radiance: sun.radiance }
    }

    /// Irradiance at a place in light space with unit `normal`, if nothing is in the way: exact.
    pub(crate) fn irradiance(&self, position: Vec3, normal: Vec3) -> Vec3 {
        match self.place {
            LampPlace::Far { direction, sine } => {
                let cosine = f64::from(Vec3::from(direction).dot(normal));
                self.radiance * cap_irradiance(cosine, f64::from(sine)) as f32
            }
            LampPlace::Near { center, radius } => {
                SphereLight { center: center.into(), radius, radiance: self.radiance }.irradiance(position, normal)
            }
        }
    }
}
