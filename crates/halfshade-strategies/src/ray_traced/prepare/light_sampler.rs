//! Directions drawn where the light is.

use super::light_tree::LightTree;
use glam::{DVec3, Mat3, Vec3};
use halfshade_scene::{
    Frame, SphereLight,
    light::{DistantLight, EnvironmentMap, Sun},
};
use std::f64::consts::{PI, TAU};

/// Everything that shines in a frame, with the means to draw a direction in proportion to its radiance.
///
/// The density per steradian is the sum of the channels of the radiance that would arrive from a direction if nothing
/// blocked, divided by its integral: one density for all lights together, with no weights to choose.
pub struct LightSampler {
    /// The environment without its sun.
    pub base: DistantLight,
    /// Its texels in proportion to their power.
    pub alias: AliasTable,
    /// The same by light times cosine, once it has been asked for.
    pub tree: Option<LightTree>,
    /// ∫ of the base's radiance over the directions that are drawn: all of them for a map, a hemisphere for constant light.
    pub base_power: f64,
    /// The sun and its power.
    pub sun: Option<(Sun, f64)>,
    /// Lights within the scene.
    pub lights: Vec<SphereLight>,
    /// Rotation.
    pub environment_from_world: Mat3,
}

/// A local light as one receiver sees it.
#[derive(Clone, Copy)]
pub(crate) struct Cap {
    axis: DVec3,
    one_minus_cosine: f64,
}

fn total(radiance: Vec3) -> f64 {
    f64::from(radiance.x) + f64::from(radiance.y) + f64::from(radiance.z)
}

impl Cap {
    pub(crate) fn of(light: &SphereLight, position: Vec3) -> Self {
        let offset = (light.center - position).as_dvec3();
        let (distance, radius) = (offset.length(), f64::from(light.radius));
        if distance <= radius {
            return Self { axis: DVec3::Y, one_minus_cosine: 2.0 };
        }
        let sine_squared = (radius / distance).powi(2);
        Self { axis: offset / distance, one_minus_cosine: sine_squared / (1.0 + (1.0 - sine_squared).sqrt()) }
    }

    pub(crate) fn of_sun(sun: &Sun) -> Self {
        let one_minus_cosine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        Self { axis: sun.direction.as_dvec3().normalize_or(DVec3::Y), one_minus_cosine }
    }

    pub(crate) fn solid_angle(&self) -> f64 {
        TAU * self.one_minus_cosine
    }

    fn contains(&self, direction: DVec3) -> bool {
        0.5 * direction.distance_squared(self.axis) <= self.one_minus_cosine
    }

    pub(crate) fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        about(self.axis, u * self.one_minus_cosine, v)
    }

    /// To the surface of the light, along a unit direction that meets it.
    pub(crate) fn distance(light: &SphereLight, position: Vec3, direction: DVec3) -> f32 {
        let offset = (light.center - position).as_dvec3();
        let along = offset.dot(direction);
        let half_chord = (f64::from(light.radius).powi(2) - offset.length_squared() + along * along).max(0.0).sqrt();
        let near = along - half_chord;
        (if near > 0.0 { near } else { along + half_chord }) as f32
    }
}

/// The unit vector whose cosine to unit `axis` is `1 - one_minus_cosine`, at `turn` of a full turn around it.
pub(crate) fn about(axis: DVec3, one_minus_cosine: f64, turn: f64) -> DVec3 {
    let sine = (one_minus_cosine * (2.0 - one_minus_cosine)).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    let (t, b) = axis.any_orthonormal_pair();
    sine * (x * t + y * b) + (1.0 - one_minus_cosine) * axis
}

/// A direction around unit `normal` with density cosine/π.
pub(crate) fn cosine_direction(normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    about(normal, u / (1.0 + (1.0 - u).sqrt()), v)
}

impl LightSampler {
    /// Takes over the alias table of `previous` if the map is the same.
    pub fn new(frame: &Frame<'_>, previous: Option<Self>) -> Self {
        let environment = &frame.scene.environment;
        let (alias, tree) = match (&environment.base, previous) {
            (base, Some(old)) if old.base.is_same_as(base) => (old.alias, old.tree),
            (DistantLight::Map(map), _) => (AliasTable::new(&texel_powers(map)), None),
            (DistantLight::Constant(_), _) => (AliasTable::default(), None),
        };
        let base_power = match &environment.base {
            DistantLight::Constant(radiance) => TAU * total(*radiance),
            DistantLight::Map(_) => alias.sum,
        };
        let sun = environment.sun.map(|sun| (sun, total(sun.radiance) * Cap::of_sun(&sun).solid_angle()));
        Self {
            base: environment.base.clone(),
            alias,
            tree,
            base_power,
            sun,
            lights: frame.lights.clone(),
            environment_from_world: Mat3::from_quat(frame.world_from_environment.normalize().conjugate()),
        }
    }

    /// Makes directions of a map be drawn by light times cosine, too.
    pub fn with_tree(mut self) -> Self {
        if let (DistantLight::Map(map), None) = (&self.base, &self.tree) {
            self.tree = Some(LightTree::new(map));
        }
        self
    }

    /// Whether drawing by light can do better than drawing by cosine.
    pub fn is_constant(&self) -> bool {
        matches!(self.base, DistantLight::Constant(_)) && self.sun.is_none() && self.lights.is_empty()
    }

    /// ∫ of all radiance that could arrive at `position`, summed over the channels.
    pub(crate) fn power(&self, position: Vec3) -> f64 {
        let local: f64 =
            self.lights.iter().map(|light| total(light.radiance) * Cap::of(light, position).solid_angle()).sum();
        self.base_power + self.sun.map_or(0.0, |(_, power)| power) + local
    }

    /// A direction for a receiver, in proportion to radiance; `power` as [`Self::power`] gave it.
    pub(crate) fn sample(&self, position: Vec3, normal: DVec3, power: f64, [choice, u, v]: [f64; 3]) -> DVec3 {
        let world_from_environment = self.environment_from_world.transpose().as_dmat3();
        let mut left = choice * power;
        if left < self.base_power {
            return match &self.base {
                DistantLight::Constant(_) => about(normal, u, v),
                DistantLight::Map(map) => world_from_environment * self.alias.direction(map, [u, v]),
            };
        }
        left -= self.base_power;
        if let Some((sun, sun_power)) = &self.sun {
            if left < *sun_power {
                return world_from_environment * Cap::of_sun(sun).sample([u, v]);
            }
            left -= sun_power;
        }
        let mut last = normal;
        for light in &self.lights {
            let cap = Cap::of(light, position);
            last = cap.sample([u, v]);
            left -= total(light.radiance) * cap.solid_angle();
            if left < 0.0 {
                break;
            }
        }
        last
    }

    /// Radiance from infinitely far along unit `direction`.
    pub(crate) fn distant_radiance(&self, direction: DVec3) -> Vec3 {
        let direction = (self.environment_from_world.as_dmat3() * direction).normalize();
        let base = match &self.base {
            DistantLight::Constant(radiance) => *radiance,
            DistantLight::Map(map) => map.radiance(direction.as_vec3()),
        };
        match &self.sun {
            Some((sun, _)) if Cap::of_sun(sun).contains(direction) => base + sun.radiance,
            _ => base,
        }
    }

    /// All radiance along a ray that nothing blocks.
    pub(crate) fn radiance(&self, position: Vec3, direction: DVec3) -> DVec3 {
        let distant = self.distant_radiance(direction);
        self.local_radiance(position, direction).fold(distant, |sum, (radiance, _)| sum + radiance).as_dvec3()
    }

    /// The local lights along a ray: radiance, and the distance to the light's surface.
    pub(crate) fn local_radiance(&self, position: Vec3, direction: DVec3) -> impl Iterator<Item = (Vec3, f32)> {
        let hit = move |light: &&SphereLight| Cap::of(light, position).contains(direction);
        self.lights.iter().filter(hit).map(move |light| (light.radiance, Cap::distance(light, position, direction)))
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.alias.cells.as_slice()) + self.tree.as_ref().map_or(0, LightTree::bytes)
    }
}

/// Texel solid angle times the sum of the channels.
fn texel_powers(map: &EnvironmentMap) -> Vec<f64> {
    map.texels()
        .chunks_exact(map.width())
        .enumerate()
        .flat_map(|(row, texels)| {
            let solid_angle = map.texel_solid_angle(row);
            texels.iter().map(move |texel| solid_angle * total(*texel))
        })
        .collect()
}

/// Walker's alias method (Vose 1991): an index drawn in proportion to its weight in constant time.
#[derive(Debug, Default)]
pub struct AliasTable {
    /// Chance to stay, and where to go otherwise.
    pub cells: Vec<(f64, u32)>,
    sum: f64,
}

impl AliasTable {
    fn new(weights: &[f64]) -> Self {
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 || sum.is_nan() {
            return Self::default();
        }
        let mut cells: Vec<(f64, u32)> =
            weights.iter().enumerate().map(|(i, w)| (w * weights.len() as f64 / sum, i as u32)).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..cells.len()).partition(|&i| cells[i].0 < 1.0);
        while let (Some(&poor), Some(&rich)) = (small.last(), large.last()) {
            small.pop();
            cells[poor].1 = rich as u32;
            cells[rich].0 -= 1.0 - cells[poor].0;
            if cells[rich].0 < 1.0 {
                large.pop();
                small.push(rich);
            }
        }
        // The rest differs from 1 by rounding.
        small.into_iter().chain(large).for_each(|i| cells[i].0 = 1.0);
        Self { cells, sum }
    }

    /// An index, and what is left of `u`, again uniform in [0, 1).
    fn sample(&self, u: f64) -> (usize, f64) {
        let place = u * self.cells.len() as f64;
        let cell = (place as usize).min(self.cells.len() - 1);
        let (stay, alias) = self.cells[cell];
        let rest = (place - cell as f64).min(1.0);
        if rest < stay { (cell, rest / stay) } else { (alias as usize, (rest - stay) / (1.0 - stay)) }
    }

    fn direction(&self, map: &EnvironmentMap, [u, v]: [f64; 2]) -> DVec3 {
        let (texel, u) = self.sample(u);
        let (row, column) = (texel / map.width(), texel % map.width());
        let edge = |row: usize| (PI * row as f64 / map.height() as f64).cos();
        let up = edge(row) + v * (edge(row + 1) - edge(row));
        let (sin, cos) = (((column as f64 + u) / map.width() as f64 - 0.5) * TAU).sin_cos();
        let across = (1.0 - up * up).max(0.0).sqrt();
        DVec3::new(across * sin, up, -across * cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::empty;
    use halfshade_scene::{Environment, Motion, Pose};

    #[test]
    fn alias_table_keeps_the_weights() {
        let weights = [0.0, 3.0, 1.0, 0.5, 0.0, 10.0, 0.25];
        let table = AliasTable::new(&weights);
        let mut shares = [0.0; 7];
        for (i, &(stay, alias)) in table.cells.iter().enumerate() {
            shares[i] += stay / 7.0;
            shares[alias as usize] += (1.0 - stay) / 7.0;
        }
        for (share, weight) in shares.iter().zip(weights) {
            assert!((share - weight / 14.75).abs() < 1e-15);
        }
    }

    /// The mean of radiance / density over drawn directions is the power itself, for every direction: density is
    /// radiance over power. So drawn directions must shine, and fall into each light as often as its share says.
    #[test]
    fn directions_are_drawn_in_proportion_to_radiance() {
        let texels = (0..32).map(|i| Vec3::splat(if i % 3 == 0 { i as f32 } else { 0.0 })).collect();
        let mut environment = Environment::map(EnvironmentMap::new(8, 4, texels).unwrap());
        let sun_direction = Vec3::new(0.3, 0.9, -0.2).normalize();
        environment.sun = Some(Sun { direction: sun_direction, angular_radius: 0.02, radiance: Vec3::splat(5e4) });
        let mut scene = empty(environment);
        let light = SphereLight { center: Vec3::new(2.0, 3.0, 1.0), radius: 0.5, radiance: Vec3::splat(400.0) };
        scene.lights.push((light, Motion::Still(Pose::IDENTITY)));
        let mut frame = scene.frame(0);
        frame.world_from_environment = glam::Quat::from_rotation_x(0.4);
        let sampler = LightSampler::new(&frame, None);
        let power = sampler.power(Vec3::ZERO);
        let points = crate::ray_traced::shade::points::Points::<3>::new(5);
        let count = 20_000;
        let (mut in_sun, mut in_light, mut in_texel) = (0u32, 0u32, 0u32);
        for i in 0..count {
            let direction = sampler.sample(Vec3::ZERO, DVec3::Y, power, points.at(i));
            assert!((direction.length() - 1.0).abs() < 1e-6);
            let local = sampler.local_radiance(Vec3::ZERO, direction).next();
            assert!(sampler.distant_radiance(direction).x > 0.0 || local.is_some());
            let in_environment = frame.world_from_environment.conjugate() * direction.as_vec3();
            if in_environment.distance(sun_direction) < 0.0201 {
                in_sun += 1;
            } else if let Some((_, distance)) = local {
                in_light += 1;
                assert!((3.2..3.75).contains(&distance));
            } else if scene.environment.radiance(in_environment).x == 15.0 {
                in_texel += 1;
            }
        }
        let share = |n: u32, power_of: f64| (f64::from(n) / f64::from(count), power_of / power);
        let cap = |angle: f64| TAU * (1.0 - angle.cos());
        let DistantLight::Map(map) = &scene.environment.base else { panic!() };
        for (seen, expected) in [
            share(in_sun, 3.0 * 5e4 * cap(0.02)),
            share(in_light, 1200.0 * cap((0.5 / 14f64.sqrt()).asin())),
            share(in_texel, 45.0 * map.texel_solid_angle(1)),
        ] {
            assert!((seen - expected).abs() < 0.01, "{seen} {expected}");
        }
    }
}
