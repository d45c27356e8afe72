//! The light of a frame as separate integrals, and how each one is sampled.
//!
//! | integral | techniques |
//! | --- | --- |
//! | constant distant light | cosine |
//! | distant map | cosine and map, balance heuristic |
//! | sun | its cap, uniformly by solid angle |
//! | local sphere, small | its cap, uniformly by solid angle |
//! | local sphere, large | cap and cosine, balance heuristic |
//! | local sphere around the receiver | cosine |

use crate::{
    batch::{BATCH, Batch},
    directions::Axes,
    environment::MapSampler,
    light_cap::LightCap,
    map_irradiance::MapIrradiance,
    points::{Scramble, unit_f32},
    receiver::Receiver,
    source::Source,
    space::TracingSpace,
    sphere_irradiance::sphere_irradiance,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Frame, SphereLight, light::DistantLight};
use std::f64::consts::{PI, TAU};

/// From this solid angle in steradians on, a local light is sampled by cosine too: over a wide cap the cosine varies
/// more than anything else.
const WIDE_CAP: f64 = 1.0;

/// Distant light without its sun.
#[derive(Debug)]
enum Distant {
    Constant(Vec3),
    Map(Box<MapLight>),
}

/// A map, for sampling and for its unshadowed irradiance.
#[derive(Debug)]
struct MapLight {
    sampler: MapSampler,
    irradiance: MapIrradiance,
}

/// All light of a frame.
#[derive(Debug)]
pub(crate) struct Lights {
    distant: Distant,
    /// Direction in world space, angular radius, radiance.
    sun: Option<(DVec3, f64, Vec3)>,
    local: Vec<SphereLight>,
}

/// One of the integrals that direct light is the sum of.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Integral {
    Distant,
    Sun,
    Local(usize),
}

/// One way to draw directions for an integral.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Technique {
    /// Cosine over the hemisphere, for distant light.
    DistantCosine,
    /// Radiance of the map.
    DistantMap,
    /// A cap of constant radiance; the density of cosine sampling is added if `wide`.
    Cap { cap: LightCap, wide: bool },
    /// Cosine over the hemisphere, for a local sphere that is wide or surrounds the receiver.
    LocalCosine { cap: LightCap },
}

impl Lights {
    pub(crate) fn new(frame: &Frame<'_>) -> Self {
        let environment = &frame.scene.environment;
        let distant = match &environment.base {
            DistantLight::Constant(radiance) => Distant::Constant(*radiance),
            DistantLight::Map(map) => Distant::Map(Box::new(MapLight {
                sampler: MapSampler::new(map, frame.world_from_environment),
                irradiance: MapIrradiance::new(map, frame.world_from_environment),
            })),
        };
        let sun = environment.sun.filter(|sun| sun.radiance != Vec3::ZERO && sun.angular_radius > 0.0).map(|sun| {
            let direction = frame.world_from_environment.as_dquat() * sun.direction.as_dvec3();
            (direction.normalize_or(DVec3::Y), f64::from(sun.angular_radius).min(PI / 2.0), sun.radiance)
        });
        let local = frame.lights.iter().filter(|l| l.radiance != Vec3::ZERO && l.radius > 0.0).copied().collect();
        Self { distant, sun, local }
    }

    /// The integrals that are not zero everywhere.
    pub(crate) fn integrals(&self) -> impl Iterator<Item = Integral> {
        let dark = match &self.distant {
            Distant::Constant(radiance) => *radiance == Vec3::ZERO,
            Distant::Map(map) => map.sampler.is_black(),
        };
        (!dark)
            .then_some(Integral::Distant)
            .into_iter()
            .chain(self.sun.map(|_| Integral::Sun))
            .chain((0..self.local.len()).map(Integral::Local))
    }

    /// Irradiance with nothing in the way: exact for constant light, suns and spheres, by deterministic quadrature for
    /// maps (see [`MapIrradiance`]).
    pub(crate) fn unshadowed(&self, integral: Integral, receiver: &Receiver) -> DVec3 {
        match (integral, &self.distant) {
            (Integral::Distant, Distant::Constant(radiance)) => PI * radiance.as_dvec3(),
            (Integral::Distant, Distant::Map(map)) => map.irradiance.at(receiver.normal),
            (Integral::Sun, _) => self.sun.map_or(DVec3::ZERO, |(direction, angular_radius, radiance)| {
                sphere_irradiance(angular_radius.sin(), direction.dot(receiver.normal)) * radiance.as_dvec3()
            }),
            (Integral::Local(number), _) => {
                let light = &self.local[number];
                let offset = light.center.as_dvec3() - receiver.position;
                let (distance, radius) = (offset.length(), f64::from(light.radius));
                let irradiance = if distance <= radius {
                    PI
                } else {
                    sphere_irradiance(radius / distance, offset.dot(receiver.normal) / distance)
                };
                irradiance * light.radiance.as_dvec3()
            }
        }
    }

    /// The techniques for one integral at one receiver.
    pub(crate) fn techniques(
        &self,
        integral: Integral,
        receiver: &Receiver,
        space: &TracingSpace,
    ) -> [Option<Technique>; 2] {
        match integral {
            Integral::Distant => match &self.distant {
                Distant::Constant(_) => [Some(Technique::DistantCosine), None],
                Distant::Map(_) => [Some(Technique::DistantCosine), Some(Technique::DistantMap)],
            },
            Integral::Sun => {
                let cap = self.sun.map(|(direction, angular_radius, radiance)| LightCap {
                    axes: Axes::around(direction),
                    distance: f64::INFINITY,
                    radius: 0.0,
                    one_minus_cosine: 2.0 * (0.5 * angular_radius).sin().powi(2),
                    radiance,
                });
                [cap.map(|cap| Technique::Cap { cap, wide: false }), None]
            }
            Integral::Local(number) => {
                let light = &self.local[number];
                let offset = light.center.as_dvec3() - receiver.position;
                let (distance, radius) = (offset.length(), f64::from(light.radius));
                let sine_squared = (radius / distance).powi(2);
                let inside = distance <= radius;
                let cap = LightCap {
                    axes: Axes::around(offset.normalize_or(DVec3::Y)),
                    distance: space.length(distance),
                    radius: space.length(radius),
                    one_minus_cosine: if inside { 2.0 } else { sine_squared / (1.0 + (1.0 - sine_squared).sqrt()) },
                    radiance: light.radiance,
                };
                let wide = TAU * cap.one_minus_cosine > WIDE_CAP;
                [
                    (!inside).then_some(Technique::Cap { cap, wide }),
                    (inside || wide).then_some(Technique::LocalCosine { cap }),
                ]
            }
        }
    }

    /// The light of one integral as a receiver sees it, for glossy receivers.
    pub(crate) fn source(&self, integral: Integral, receiver: &Receiver, space: &TracingSpace) -> Source<'_> {
        match (&self.distant, self.techniques(integral, receiver, space)) {
            (_, [Some(Technique::Cap { cap, .. } | Technique::LocalCosine { cap }), _])
            | (_, [_, Some(Technique::Cap { cap, .. } | Technique::LocalCosine { cap })]) => Source::Cap(cap),
            (Distant::Constant(radiance), _) => Source::Constant(*radiance),
            (Distant::Map(map), _) => Source::Map(&map.sampler),
        }
    }

    /// Draws samples of `technique` for at most [`BATCH`] points.
    pub(crate) fn sample(
        &self,
        technique: &Technique,
        receiver: &Receiver,
        points: &[[u32; 2]],
        scramble: Scramble,
        batch: &mut Batch,
    ) {
        batch.len = points.len();
        match technique {
            Technique::DistantCosine => {
                sample_cosine(receiver, points, scramble, batch);
                batch.distance = [f32::INFINITY; BATCH];
                match &self.distant {
                    Distant::Constant(radiance) => {
                        // Radiance times cosine over cosine/π is the same for every direction.
                        let value = (PI * radiance.as_dvec3()).as_vec3().to_array();
                        for (channel, value) in batch.value.iter_mut().zip(value) {
                            *channel = [value; BATCH];
                        }
                    }
                    Distant::Map(map) => map.sampler.weigh_cosine_samples(receiver, batch),
                }
            }
            Technique::DistantMap => {
                batch.distance = [f32::INFINITY; BATCH];
                if let Distant::Map(map) = &self.distant {
                    map.sampler.sample(receiver, points, scramble, batch);
                }
            }
            Technique::Cap { cap, wide } => cap.sample(*wide, receiver, points, scramble, batch),
            Technique::LocalCosine { cap } => {
                sample_cosine(receiver, points, scramble, batch);
                cap.weigh_cosine_samples(receiver, batch);
            }
        }
        batch.clear_rest();
    }
}

/// Fills directions with the density cos/π.
fn sample_cosine(receiver: &Receiver, points: &[[u32; 2]], scramble: Scramble, batch: &mut Batch) {
    for (k, &point) in points.iter().enumerate() {
        let [u, v] = scramble.apply(point).map(unit_f32);
        batch.set_direction(k, receiver.axes.direction(u.sqrt(), (1.0 - u).sqrt(), v));
    }
}
