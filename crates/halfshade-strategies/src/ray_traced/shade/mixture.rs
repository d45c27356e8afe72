//! Rays of a receiver by cosine, or all of its lobes, and by light.

use super::{
    FrameRays,
    outcome::{Outcome, Sums},
    points::Points,
    reflector::Reflector,
};
use crate::ray_traced::prepare::light_sampler::cosine_direction;
use glam::{DVec3, Vec3};
use halfshade_scene::{Lobe, Lobes, Receivers};
use std::f64::consts::PI;

impl FrameRays<'_> {
    /// Diffuse.
    pub(super) fn by_mixture(&self, receivers: &Receivers<'_>, i: usize) -> Outcome {
        let light = self.light;
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        let axis = normal.as_dvec3().normalize_or(DVec3::Y);
        let cosine_share = self.cosine_share;
        let power = light.power(position);
        if power <= 0.0 {
            return Outcome::BLACK;
        }
        let index = receivers.index[i];
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
        let albedo = receivers.albedo_at(i);
        match self.known(albedo, position, normal) {
            Some(known) => Outcome { known, share: sums.share().as_vec3(), ..Outcome::BLACK },
            None => Outcome { apart: albedo * self.mean(&sums).as_vec3(), ..Outcome::BLACK },
        }
    }

    /// Radiance of a diffuse receiver that nothing hides, if it is to be known.
    fn known(&self, albedo: Vec3, position: Vec3, normal: Vec3) -> Option<Vec3> {
        let irradiance = self.irradiance.as_ref().filter(|_| self.is_ratio)?;
        Some(albedo * (irradiance.at(position, normal).as_dvec3() / PI).as_vec3())
    }

    fn mean(&self, sums: &Sums) -> DVec3 {
        sums.seen / f64::from(self.samples)
    }

    /// Radiance of a glossy receiver: the same with all of its lobes in place of the cosine.
    pub(super) fn glossy(&self, receivers: &Receivers<'_>, i: usize, lobes: Lobes) -> Outcome {
        let light = self.light;
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        let axis = normal.as_dvec3().normalize_or(DVec3::Y);
        let albedo = receivers.albedo_at(i);
        let reflector = Reflector::new(lobes, Lobe::diffuse(albedo, normal), axis);
        let share = self.cosine_share;
        let power = light.power(position);
        if power <= 0.0 {
            return Outcome::BLACK;
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
                let weight = axis.dot(direction) / (PI * density);
                diffuse.add(weight * seen, weight * arriving);
            }
        }
        let all = sum / f64::from(self.samples);
        let Some(known) = self.known(albedo, position, normal) else {
            return Outcome { apart: all.as_vec3(), ..Outcome::BLACK };
        };
        // The diffuse part is in all of it by these very samples.
        let apart = (all - albedo.as_dvec3() * self.mean(&diffuse)).max(DVec3::ZERO).as_vec3();
        Outcome { apart, known, share: diffuse.share().as_vec3() }
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
        let weight = cosine / (PI * density);
        sums.add(weight * self.seen(position, normal, direction), weight * arriving);
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
