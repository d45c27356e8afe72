//! Rays of each receiver.

pub(super) mod points;
mod reflector;

use super::prepare::{
    light_sampler::{LightSampler, cosine_direction},
    occlusion::Occlusion,
};
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
        let mut sum = DVec3::ZERO;
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
            sum += self.one_sample(position, axis, direction, cosine_share, power);
        }
        (sum / f64::from(self.samples)).as_vec3()
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
        let mut sum = DVec3::ZERO;
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
                sum += reflectance * self.seen(position, axis, direction) / density;
            }
        }
        (sum / f64::from(self.samples)).as_vec3()
    }

    /// L V cosθ / (π p) along one direction.
    fn one_sample(&self, position: Vec3, normal: DVec3, direction: DVec3, cosine_share: f64, power: f64) -> DVec3 {
        let cosine = normal.dot(direction);
        if cosine <= 0.0 {
            return DVec3::ZERO;
        }
        let arriving = self.light.radiance(position, direction);
        let by_light = arriving.element_sum() / power;
        let density = cosine_share * cosine / PI + (1.0 - cosine_share) * by_light;
        if arriving == DVec3::ZERO || density <= 0.0 {
            return DVec3::ZERO;
        }
        self.seen(position, normal, direction) * (cosine / (PI * density))
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
