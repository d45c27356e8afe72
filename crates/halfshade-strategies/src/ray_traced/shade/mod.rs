//! Rays of each receiver.

pub(super) mod points;
mod reflector;

use super::prepare::{
    light_sampler::{LightSampler, cosine_direction},
    occlusion::Occlusion,
};
use crate::shared::irradiance::FrameIrradiance;
use glam::{DVec3, Vec3};
use halfshade_scene::{EyeLobes, Lobe, Lobes, RadianceMut, Receivers};
use halfshade_strategy::Prepared;
use points::Points;
use reflector::Reflector;
use std::f64::consts::PI;

/// A frame ready to be shaded.
pub(super) struct FrameRays<'a> {
    pub(super) samples: u32,
    /// Share of directions drawn by cosine, or by the lobes of a glossy receiver.
    pub(super) cosine_share: f64,
    pub(super) occlusion: Occlusion<'a>,
    pub(super) light: &'a LightSampler,
    /// All of the light, if rays are to tell only the share of it that is seen.
    pub(super) irradiance: Option<FrameIrradiance<'a>>,
    /// Lobes by which receivers reflect towards the eye, if anything is glossy.
    pub(super) eye_lobes: Option<EyeLobes>,
}

impl FrameRays<'_> {
    fn radiance(&self, position: Vec3, normal: Vec3, index: u32) -> Vec3 {
        let light = self.light;
        let axis = normal.as_dvec3().normalize_or(DVec3::Y);
        let cosine_share = self.cosine_share;
        let power = light.power(position);
        if power <= 0.0 {
            return Vec3::ZERO;
        }
        let (plane, space) = (Points::<2>::new(index), Points::<3>::new(index));
        let mut sums = Sums::default();
        for i in 0..self.samples {
            let direction = if cosine_share == 1.0 {
                cosine_direction(axis, plane.at(i))
            } else {
                let [choice, u, v] = space.at(i);
                if choice < cosine_share {
                    cosine_direction(axis, [u, v])
                } else {
                    let choice = (choice - cosine_share) / (1.0 - cosine_share);
                    light.sample(position, axis, power, [choice, u, v])
                }
            };
            self.add_sample(&mut sums, (position, axis), direction, power);
        }
        self.estimate(&sums, position, normal).as_vec3()
    }

    /// Outgoing radiance of a white receiver by its samples.
    fn estimate(&self, sums: &Sums, position: Vec3, normal: Vec3) -> DVec3 {
        match &self.irradiance {
            None => sums.seen / f64::from(self.samples),
            Some(irradiance) => irradiance.at(position, normal).as_dvec3() / PI * sums.share(),
        }
    }

    /// Radiance of a glossy receiver: the same with all of its lobes in place of the cosine.
    fn glossy(&self, receivers: &Receivers<'_>, i: usize, lobes: Lobes) -> Vec3 {
        let light = self.light;
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        let axis = normal.as_dvec3().normalize_or(DVec3::Y);
        let reflector = Reflector::new(lobes, Lobe::diffuse(receivers.albedo_at(i), normal), axis);
        let share = self.cosine_share;
        let power = light.power(position);
        if power <= 0.0 {
            return Vec3::ZERO;
        }
        let points = Points::<3>::new(receivers.index[i]);
        let (mut sum, mut diffuse) = (DVec3::ZERO, Sums::default());
        for k in 0..self.samples {
            let [choice, u, v] = points.at(k);
            let direction = if choice < share {
                reflector.sample([choice / share, u, v])
            } else {
                light.sample(position, axis, power, [(choice - share) / (1.0 - share), u, v])
            };
            if axis.dot(direction) <= 0.0 {
                continue;
            }
            let (reflectance, by_reflectance) = reflector.evaluate(direction);
            let arriving = light.radiance(position, direction);
            let density = share * by_reflectance + (1.0 - share) * arriving.element_sum() / power;
            if arriving != DVec3::ZERO && density > 0.0 {
                let seen = self.seen(position, axis, direction);
                sum += reflectance * seen / density;
                diffuse.add(axis.dot(direction) / (PI * density), seen, arriving);
            }
        }
        let all = sum / f64::from(self.samples);
        if self.irradiance.is_none() {
            return all.as_vec3();
        }
        // The diffuse part is in all of it by these very samples.
        let estimated = self.estimate(&diffuse, position, normal) - diffuse.seen / f64::from(self.samples);
        (all + receivers.albedo_at(i).as_dvec3() * estimated).max(DVec3::ZERO).as_vec3()
    }

    /// Adds L V cosθ / (π p) along one direction, and the same without V.
    fn add_sample(&self, sums: &mut Sums, (position, normal): (Vec3, DVec3), direction: DVec3, power: f64) {
        let cosine = normal.dot(direction);
        if cosine <= 0.0 {
            return;
        }
        let arriving = self.light.radiance(position, direction);
        let by_light = arriving.element_sum() / power;
        let density = self.cosine_share * cosine / PI + (1.0 - self.cosine_share) * by_light;
        if arriving == DVec3::ZERO || density <= 0.0 {
            return;
        }
        sums.add(cosine / (PI * density), self.seen(position, normal, direction), arriving);
    }

    /// The radiance that arrives along a direction and isn't blocked.
    fn seen(&self, position: Vec3, normal: DVec3, direction: DVec3) -> DVec3 {
        let distant = self.light.distant_radiance(direction);
        let (ray, lift) = (direction.as_vec3(), normal.as_vec3());
        let seen = |distance| !self.occlusion.blocked(position, lift, ray, distance);
        let mut radiance = if distant != Vec3::ZERO && seen(f32::INFINITY) { distant } else { Vec3::ZERO };
        for (from_light, distance) in self.light.local_radiance(position, direction) {
            if seen(distance) {
                radiance += from_light;
            }
        }
        radiance.as_dvec3()
    }
}

/// Light of the samples of a receiver.
#[derive(Default)]
struct Sums {
    /// Blocked where it is, and as if nothing were.
    seen: DVec3,
    open: DVec3,
}

impl Sums {
    fn add(&mut self, weight: f64, seen: DVec3, arriving: DVec3) {
        self.seen += weight * seen;
        self.open += weight * arriving;
    }

    /// The share that is seen, by channel; all of it where no sample carries light.
    fn share(&self) -> DVec3 {
        let share =
            |channel: usize| if self.open[channel] > 0.0 { self.seen[channel] / self.open[channel] } else { 1.0 };
        DVec3::new(share(0), share(1), share(2)).min(DVec3::ONE)
    }
}

impl Prepared for FrameRays<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        for i in 0..receivers.len() {
            let lobes = self.eye_lobes.as_ref().map_or(Lobes::NONE, |lobes| lobes.at(&receivers, i));
            if !lobes.is_empty() {
                out.set(i, self.glossy(&receivers, i, lobes));
                continue;
            }
            let radiance = self.radiance(receivers.position_at(i), receivers.normal_at(i), receivers.index[i]);
            out.set(i, receivers.albedo_at(i) * radiance);
        }
    }
}
