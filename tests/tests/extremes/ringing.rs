//! How far products of few bands may stray from what they are held about, see the shadow fields' bounds.

use glam::{DVec3, Vec3};
use halfshade_scene::{Environment, EyeLobes, Frame, Lobe, Receivers, light::DistantLight};
use std::f64::consts::{PI, TAU};

/// Solid angle of all directions.
const FULL: f64 = 2.0 * TAU;

/// Most that `|U - f ρ̂|` can be: `√(m I g (1 - λ g))` is largest at g = 3/8 for the clamped cosine over π, with m =
/// 1/π, I = 1 and λ = 4/3.
fn of_cosine() -> f64 {
    (3.0 / (16.0 * PI)).sqrt()
}

/// The same of a lobe, with m = λ = 1 and g = 1/2. Its integral is had from a product of few bands too: at most the
/// norms of its power and of the hemisphere, or of the cosine.
fn of_lobe(lobe: &Lobe) -> f64 {
    let power = (TAU / (2.0 * f64::from(lobe.exponent) + 1.0)).sqrt();
    let above = if lobe.times_cosine { TAU / 3.0 } else { TAU };
    0.5 * (power * above.sqrt()).sqrt()
}

/// Norm of what so many bands have of light: that of the light `√∫ L²` at most, and that of all of it in one direction,
/// `bands/√4π ∫ L`.
fn norm(bands: f32, [integral, squared]: [DVec3; 2]) -> DVec3 {
    squared.map(f64::sqrt).min(f64::from(bands) / FULL.sqrt() * integral)
}

/// `∫ L` and `∫ L²` of a cap of one radiance.
fn cap(solid_angle: f64, radiance: Vec3) -> [DVec3; 2] {
    [solid_angle * radiance.as_dvec3(), solid_angle * radiance.as_dvec3() * radiance.as_dvec3()]
}

fn distant(bands: f32, environment: &Environment) -> DVec3 {
    let base = match &environment.base {
        DistantLight::Constant(radiance) => cap(FULL, *radiance),
        DistantLight::Map(map) => {
            let texels = map.texels().iter().enumerate();
            let caps = texels.map(|(i, texel)| cap(map.texel_solid_angle(i / map.width()), *texel));
            caps.fold([DVec3::ZERO; 2], |[a, b], [c, d]| [a + c, b + d])
        }
    };
    let sun = environment.sun.map_or([DVec3::ZERO; 2], |sun| {
        let solid_angle = FULL * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        cap(solid_angle, sun.radiance)
    });
    norm(bands, base) + norm(bands, sun)
}

/// How far a receiver's radiance may be from a part of the unshadowed, of so many bands.
pub(crate) fn room(frame: &Frame<'_>, bands: f32, receivers: Receivers<'_>, i: usize) -> Vec3 {
    let mut light = distant(bands, &frame.scene.environment);
    for lamp in &frame.lights {
        let distance = lamp.center.as_dvec3().distance(receivers.position_at(i).as_dvec3());
        let sine_squared = (f64::from(lamp.radius) / distance).powi(2);
        // 2π (1 - cos), of which few digits would be left far away.
        let solid_angle =
            if sine_squared < 1.0 { TAU * sine_squared / (1.0 + (1.0 - sine_squared).sqrt()) } else { FULL };
        light += norm(bands, cap(solid_angle, lamp.radiance));
    }
    let lobes = EyeLobes::new(frame).map(|lobes| lobes.at(&receivers, i));
    let glossy: DVec3 = lobes.iter().flat_map(|lobes| lobes.iter()).map(|l| of_lobe(l) * l.scale.as_dvec3()).sum();
    (light * (of_cosine() * receivers.albedo_at(i).as_dvec3() + glossy)).as_vec3()
}
