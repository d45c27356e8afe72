//! Lights, and directions drawn where they are.

use super::{
    CALLS, compare, direction, finite, single, tolerance,
    traverse::{ray_buffers, ray_variables},
};
use glam::{DMat3, DVec3, Quat, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, RayBuffers},
};
use halfshade_scene::{
    Environment, Frame, Motion, Object, Pose, Scene, SphereLight,
    builtin::shapes,
    light::{DistantLight, EnvironmentMap, Sun},
};
use halfshade_strategies::ray_traced::arrays::LightSampler;
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// Shares of a number within which rounding decides.
const DOUBT: f64 = 1e-5;

/// Unit vector whose cosine to an axis is `1 - one_minus_cosine`, so many turns around it; `None` where rounding decides between
/// tangents.
pub(super) fn about(axis: DVec3, one_minus_cosine: f64, turn: f64) -> Option<DVec3> {
    let sine = (one_minus_cosine * (2.0 - one_minus_cosine)).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    let (first, second) = axis.any_orthonormal_pair();
    let is_decided = axis.z.abs() > DOUBT;
    is_decided.then(|| sine * (x * first + y * second) + (1.0 - one_minus_cosine) * axis)
}

/// A frame's light in double precision; `None` stands for what rounding decides.
struct Shining<'a> {
    frame: &'a Frame<'a>,
    sampler: LightSampler,
}

/// Axis, and 1 less the cosine of the angular radius.
pub(super) type Cap = (DVec3, f64);

fn contains((axis, one_minus_cosine): Cap, direction: DVec3) -> Option<bool> {
    if one_minus_cosine >= 2.0 {
        return Some(true);
    }
    let [angle, radius] =
        [0.5 * axis.distance(direction), (0.5 * one_minus_cosine).sqrt()].map(|x| 2.0 * x.min(1.0).asin());
    ((angle - radius).abs() > 1e-6).then_some(angle < radius)
}

pub(super) fn sun_cap(sun: &Sun) -> Cap {
    (sun.direction.as_dvec3().normalize(), 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2))
}

pub(super) fn cap_of(light: &SphereLight, position: DVec3) -> Cap {
    let offset = light.center.as_dvec3() - position;
    let (distance, radius) = (offset.length(), f64::from(light.radius));
    if distance <= radius {
        return (DVec3::Y, 2.0);
    }
    let squared = (radius / distance).powi(2);
    (offset / distance, squared / (1.0 + (1.0 - squared).sqrt()))
}

fn total(radiance: Vec3) -> f64 {
    radiance.as_dvec3().element_sum()
}

/// Whether a number lies between whole ones, though it may be off by as much as the arc functions of shaders may.
fn is_between(number: f64) -> bool {
    (number - number.round()).abs() > 3e-3
}

impl Shining<'_> {
    fn environment_from_world(&self) -> DMat3 {
        DMat3::from_quat(self.frame.world_from_environment.as_dquat().normalize()).transpose()
    }

    fn distant(&self, direction: DVec3) -> Option<DVec3> {
        let turned = (self.environment_from_world() * direction).normalize();
        let base = match &self.sampler.base {
            DistantLight::Constant(radiance) => *radiance,
            DistantLight::Map(map) => {
                let column = (turned.x.atan2(-turned.z) / TAU + 0.5) * map.width() as f64;
                let row = turned.y.clamp(-1.0, 1.0).acos() / PI * map.height() as f64;
                // Beyond the first row and the last there is none.
                let is_decided = is_between(column) && (is_between(row) || turned.y.abs() > 0.99);
                let row = (row as usize).min(map.height() - 1);
                is_decided.then(|| map.texels()[row * map.width() + column as usize % map.width()])?
            }
        };
        let sun = self.frame.scene.environment.sun.map(|sun| Some((contains(sun_cap(&sun), turned)?, sun.radiance)));
        Some(base.as_dvec3() + lit(sun.unwrap_or(Some((false, Vec3::ZERO)))?))
    }

    fn arriving(&self, position: DVec3, direction: DVec3) -> Option<DVec3> {
        self.frame.lights.iter().try_fold(self.distant(direction)?, |sum, light| {
            Some(sum + lit((contains(cap_of(light, position), direction)?, light.radiance)))
        })
    }

    fn power(&self, position: DVec3) -> f64 {
        let sun = self.frame.scene.environment.sun;
        let sun = sun.map_or(0.0, |sun| total(sun.radiance) * TAU * sun_cap(&sun).1);
        let local = self.frame.lights.iter().map(|light| total(light.radiance) * TAU * cap_of(light, position).1);
        self.sampler.base_power + sun + local.sum::<f64>()
    }

    fn drawn(&self, position: DVec3, normal: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        let power = self.power(position);
        let mut left = choice * power;
        // Whether a power is larger than what is left, which loses it otherwise.
        let mut is_there = |power_of: f64| {
            let is_decided = power == 0.0 || (left - power_of).abs() > DOUBT * power;
            left -= power_of;
            is_decided.then_some(left < 0.0)
        };
        let world_from_environment = self.environment_from_world().transpose();
        if is_there(self.sampler.base_power)? {
            return match &self.sampler.base {
                DistantLight::Constant(_) => about(normal, u, v),
                DistantLight::Map(map) => Some(world_from_environment * self.drawn_of_map(map, u, v)?),
            };
        }
        if let Some(sun) = &self.frame.scene.environment.sun {
            let (axis, one_minus_cosine) = sun_cap(sun);
            if is_there(total(sun.radiance) * TAU * one_minus_cosine)? {
                return Some(world_from_environment * about(axis, u * one_minus_cosine, v)?);
            }
        }
        for light in &self.frame.lights {
            let (axis, one_minus_cosine) = cap_of(light, position);
            if is_there(total(light.radiance) * TAU * one_minus_cosine)? {
                return about(axis, u * one_minus_cosine, v);
            }
        }
        (power == 0.0).then_some(normal)
    }

    fn drawn_of_map(&self, map: &EnvironmentMap, u: f64, v: f64) -> Option<DVec3> {
        let cells = &self.sampler.alias.cells;
        let place = u * cells.len() as f64;
        let (cell, rest) = (place as usize, place.fract());
        let (stay, other) = cells[cell];
        let part = if rest < stay { stay } else { 1.0 - stay };
        if !is_between(place) || (rest - stay).abs() < 1e-4 || part < 0.02 {
            return None;
        }
        let (texel, across) = if rest < stay { (cell, rest / stay) } else { (other as usize, (rest - stay) / part) };
        let edge = |row: usize| (PI * row as f64 / map.height() as f64).cos();
        let (row, column) = (texel / map.width(), (texel % map.width()) as f64);
        let y = edge(row) + v * (edge(row + 1) - edge(row));
        let (sin, cos) = (((column + across) / map.width() as f64 - 0.5) * TAU).sin_cos();
        let across = (1.0 - y * y).max(0.0).sqrt();
        Some(DVec3::new(across * sin, y, -across * cos))
    }
}

fn lit((is_there, radiance): (bool, Vec3)) -> DVec3 {
    if is_there { radiance.as_dvec3() } else { DVec3::ZERO }
}

/// Maps, suns down to a tenth of a milliradian, lamps near, far and around; light from nowhere.
pub(super) fn scenes(random: &mut Pcg64Mcg) -> Vec<Scene> {
    let sun = |angular_radius: f32| Sun {
        direction: Vec3::new(0.36, 0.48, 0.8),
        angular_radius,
        radiance: Vec3::new(9.0, 8.0, 6.0),
    };
    let mut map = |width: usize, height: usize, most: f32| {
        let texels = (0..width * height)
            .map(|i| Vec3::new(0.5, 1.0, 2.0) * most * if i % 3 == 0 { 0.0 } else { random.random() });
        let map = EnvironmentMap::new(width, height, texels.collect());
        Environment::map(map.expect("as many texels as it is large"))
    };
    let constant = Environment::constant(Vec3::new(0.5, 1.0, 1.5));
    let lights = [
        ([0.5, 2.0, 0.3], 0.5, 4.0),
        ([-2.0, 0.2, 1.0], 0.01, 100.0),
        ([0.0, 0.0, 0.0], 0.25, 3.0),
        ([0.0, 1e6, 1e6], 1e4, 10.0),
    ];
    let lights = lights.map(|(center, radius, radiance)| {
        let light = SphereLight { center: Vec3::from(center), radius, radiance: Vec3::splat(radiance) };
        (light, Motion::Still(Pose::IDENTITY))
    });
    let environments = [
        (map(8, 4, 3.0), Some(sun(0.2)), true),
        (map(7, 5, 3.0), Some(sun(0.00465)), false),
        (constant.clone(), Some(sun(1e-4)), true),
        (constant, None, false),
        (map(4, 4, 0.0), None, false),
        (map(16, 8, 1.0), None, true),
    ];
    let scene = |(environment, sun, has_lights): (Environment, Option<Sun>, bool)| {
        // A box that makes the space of kernels that of the world.
        let object = Object::new("box", shapes::cuboid(Vec3::ONE, [1; 3]));
        let mut scene = Scene::at_rest("light", vec![object], Environment { sun, ..environment });
        scene.lights.extend(lights.iter().filter(|_| has_lights).cloned());
        scene
    };
    environments.map(scene).into()
}

/// Radiance that arrives along directions into lights and beside them, its integral, distances of lamps.
pub(super) fn light(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(40);
    for (number, scene) in scenes(&mut random).iter().enumerate() {
        let mut frame = scene.frame(0);
        frame.world_from_environment = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7 * number as f32);
        let rays = ray_buffers(&frame)?;
        let shining = Shining { frame: &frame, sampler: LightSampler::new(&frame, None) };
        arriving(gpu, &shining, &rays, &mut random).map_err(|error| in_scene(number, &error))?;
        drawn(gpu, &shining, &rays, &mut random).map_err(|error| in_scene(number, &error))?;
    }
    Ok(())
}

fn in_scene(number: usize, error: &Failed) -> Failed {
    format!("light {number}: {}", error.message().unwrap_or_default()).into()
}

/// A place in a lamp, on its surface, or anywhere.
pub(super) fn position(number: usize, random: &mut Pcg64Mcg) -> DVec3 {
    match number % 16 {
        0 => DVec3::ZERO,
        1 => 0.25 * DVec3::X,
        2 => 0.2 * direction(random),
        _ => direction(random),
    }
    .as_vec3()
    .as_dvec3()
}

const SHADER: &str = "ray_traced/light.wgsl";

fn arriving(gpu: &Arc<Gpu>, shining: &Shining<'_>, rays: &RayBuffers, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let world_from_environment = shining.environment_from_world().transpose();
    let sun =
        shining.frame.scene.environment.sun.map(|sun| (world_from_environment * sun_cap(&sun).0, sun_cap(&sun).1));
    let lights = &shining.frame.lights;
    let calls: Vec<(DVec3, DVec3)> = (0..CALLS)
        .map(|i| {
            let position = position(i, random);
            // Up to twice the radius away from an axis.
            let aim = match i % 3 {
                0 => sun,
                1 if !lights.is_empty() => Some(cap_of(&lights[i / 3 % lights.len()], position)),
                _ => None,
            };
            let any = direction(random);
            let toward = aim.and_then(|(axis, one_minus_cosine)| {
                let out = random.random_range(0.0..4.0) * one_minus_cosine;
                about(axis, out.min(2.0), random.random_range(0.0..1.0))
            });
            (position, toward.unwrap_or(any).as_vec3().as_dvec3())
        })
        .collect();
    let lamp = |i: usize| i % lights.len().max(1);
    let inputs: Vec<[f32; 4]> = (calls.iter().enumerate())
        .flat_map(|(i, (position, direction))| [position.extend(lamp(i) as f64), direction.extend(0.0)])
        .map(|row| row.as_vec4().to_array())
        .collect();
    let body = "output[0] = vec4f(distant_radiance(input[1].xyz), power_at(input[0].xyz));
        output[1] = vec4f(arriving_radiance(input[0].xyz, input[1].xyz), 0.0);
        if (frame.light_count > 0u) {
            output[1].w = distance_to(light_at(u32(input[0].w)), input[0].xyz, input[1].xyz);
        }";
    let variables = ray_variables(rays);
    let found = Probe { shader: SHADER, bands: None, constants: &[], rows: [2, 2], body, variables: &variables }
        .call(gpu, &inputs)?;
    finite(&found)?;
    let (mut kept, mut expected) = (Vec::new(), Vec::new());
    for (i, ([near, far], (position, direction))) in found.as_chunks::<2>().0.iter().zip(&calls).enumerate() {
        let lamp = lights.get(lamp(i));
        let distance = lamp.map_or(Some(0.0), |light| distance_to(light, *position, *direction));
        let all = shining.distant(*direction).zip(shining.arriving(*position, *direction)).zip(distance);
        let Some(((distant, arriving), distance)) = all else { continue };
        // As shares of what they may be.
        let (size, power) = (arriving.max_element().max(1.0), shining.power(*position));
        let power = if power > 0.0 { power } else { 1.0 };
        let reach = lamp.map_or(1.0, |light| reach_of(light, *position));
        kept.push([near[0], near[1], near[2], far[3] / reach as f32]);
        expected.extend(distant.extend(distance / reach).to_array());
        kept.push(std::array::from_fn(|k| if k < 3 { far[k] / size as f32 } else { near[3] / power as f32 }));
        expected.extend((arriving / size).extend(shining.power(*position) / power).to_array());
    }
    enough(kept.len() / 2)?;
    compare("arriving", tolerance(SHADER), &kept, &expected, 8)
}

/// The most that a lamp's surface is away.
fn reach_of(light: &SphereLight, position: DVec3) -> f64 {
    light.center.as_dvec3().distance(position) + f64::from(light.radius)
}

/// Distance to a lamp's surface along a ray that meets it, or to where the ray is next to its centre.
fn distance_to(light: &SphereLight, position: DVec3, direction: DVec3) -> Option<f64> {
    let (offset, radius) = (light.center.as_dvec3() - position, f64::from(light.radius));
    let along = offset.dot(direction);
    let half_chord = (radius * radius - (offset - along * direction).length_squared()).max(0.0).sqrt();
    let near = along - half_chord;
    let is_decided = near.abs() > 1e-6 * reach_of(light, position);
    is_decided.then_some(if near > 0.0 { near } else { along + half_chord })
}

/// Most calls are beyond doubt.
fn enough(count: usize) -> Result<(), Failed> {
    if count < CALLS * 4 / 5 { Err(format!("only {count} calls are beyond doubt").into()) } else { Ok(()) }
}

fn drawn(gpu: &Arc<Gpu>, shining: &Shining<'_>, rays: &RayBuffers, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let calls: Vec<(DVec3, DVec3, [f64; 3])> = (0..CALLS)
        .map(|i| {
            let numbers = [(); 3].map(|()| single(random.random_range(0.0..1.0)));
            let numbers = [0, 1, 2].map(|k| if i % 64 == k { 0.0 } else { numbers[k] });
            (position(i, random), direction(random), numbers)
        })
        .collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .flat_map(|(position, normal, numbers)| [*position, *normal, DVec3::from(*numbers)])
        .map(|row| row.extend(0.0).as_vec4().to_array())
        .collect();
    let body = "let power = power_at(input[0].xyz);
        let drawn = light_direction(input[0].xyz, input[1].xyz, power, input[2].x, input[2].y, input[2].z);
        output[0] = vec4f(drawn, 0.0);
        output[1] = vec4f(cosine_direction(input[1].xyz, input[2].y, input[2].z), 0.0);";
    let variables = ray_variables(rays);
    let found = Probe { shader: SHADER, bands: None, constants: &[], rows: [3, 2], body, variables: &variables }
        .call(gpu, &inputs)?;
    finite(&found)?;
    let (mut kept, mut expected) = (Vec::new(), Vec::new());
    for ([by_light, by_cosine], (position, normal, numbers)) in found.as_chunks::<2>().0.iter().zip(&calls) {
        let [_, u, v] = *numbers;
        let cosine = about(*normal, u / (1.0 + (1.0 - u).sqrt()), v);
        let Some((light, cosine)) = shining.drawn(*position, *normal, *numbers).zip(cosine) else { continue };
        kept.extend([*by_light, *by_cosine]);
        expected.extend([light, cosine].into_iter().flat_map(|direction| direction.extend(0.0).to_array()));
    }
    enough(kept.len() / 2)?;
    compare("drawn", tolerance(SHADER), &kept, &expected, 8)
}
