//! Rays of a diffuse receiver by light times cosine.

use super::{
    FrameRays,
    outcome::{Outcome, Sums},
    sequence::{Sequence, offset_of},
};
use crate::{
    ray_traced::prepare::light_sampler::{Cap, cosine_direction},
    shared::irradiance::FrameIrradiance,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Receivers, light::DistantLight};
use std::f32::consts::PI;

/// A receiver as its rays need it.
struct Place {
    position: Vec3,
    normal: Vec3,
    normal_in_environment: Vec3,
}

/// A direction drawn for one light.
struct Drawn {
    direction: Vec3,
    /// Light times cosine over the density.
    arriving: Vec3,
    /// To what shines.
    distance: f32,
}

impl FrameRays<'_> {
    /// Light of each in turn (environment, sun, lamps): as many of the rays as its irradiance is a part of all, give or take
    /// one, equal steps apart. A light's share is told by its own rays; one too weak for a whole ray that has one stands for
    /// its like.
    pub(super) fn by_product(&self, irradiance: &FrameIrradiance<'_>, receivers: &Receivers<'_>, i: usize) -> Outcome {
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        let parts = || irradiance.parts(position, normal);
        let total: f32 = parts().map(Vec3::element_sum).sum();
        if total <= 0.0 || total.is_nan() {
            return Outcome::BLACK;
        }
        let index = receivers.index[i];
        let offset = offset_of(index);
        let unit = normal.as_dvec3().normalize_or(DVec3::Y).as_vec3();
        let normal_in_environment = (self.light.environment_from_world * unit).normalize_or(Vec3::Y);
        let place = Place { position, normal: unit, normal_in_environment };
        let step = total / self.samples as f32;
        // Irradiance by the share of each light; and unbiased, a ray's light over its chance.
        let (mut all, mut plain) = (Sums::default(), DVec3::ZERO);
        let (mut end, mut next) = (0.0, 0);
        for (number, part) in parts().enumerate() {
            let own = part.element_sum();
            end += own;
            let mut sums = Sums::default();
            // Samples that lie before the end of this light.
            let stop = ((end / step - offset).ceil().max(0.0) as u32).clamp(next, self.samples);
            let sequence = Sequence::new(index, stop - next);
            for point in (0..stop - next).map(|k| sequence.at(k)) {
                if let Some(drawn) = self.drawn(number, &place, point) {
                    let arriving = drawn.arriving.as_dvec3();
                    let is_hidden = self.occlusion.blocked(position, unit, drawn.direction, drawn.distance);
                    sums.add(if is_hidden { DVec3::ZERO } else { arriving }, arriving);
                }
            }
            next = stop;
            if sums.open != DVec3::ZERO {
                let open = (part * (step / own).max(1.0)).as_dvec3();
                all.add(open * sums.share(), open);
                plain += sums.seen * f64::from(step / own);
            }
        }
        let albedo = receivers.albedo_at(i) / PI;
        if self.is_ratio {
            let known = albedo * irradiance.at(position, normal);
            return Outcome { known, share: all.share().as_vec3(), ..Outcome::BLACK };
        }
        Outcome { apart: albedo * plain.as_vec3(), ..Outcome::BLACK }
    }

    fn drawn(&self, number: usize, place: &Place, [u, v]: [f32; 2]) -> Option<Drawn> {
        let light = self.light;
        let pair = [f64::from(u), f64::from(v)];
        let far = |direction: Vec3, arriving| Drawn { direction, arriving, distance: f32::INFINITY };
        let world_from_environment = light.environment_from_world.transpose();
        let drawn = match number {
            0 => match (&light.base, &light.tree) {
                (DistantLight::Map(map), Some(tree)) => {
                    let found = tree.sample(place.normal_in_environment, [u, v])?;
                    let cosine = place.normal_in_environment.dot(found.direction).max(0.0);
                    let weight = cosine * found.inverse_density;
                    far(world_from_environment * found.direction, map.texels()[found.texel] * weight)
                }
                (DistantLight::Map(_), None) => return None,
                (DistantLight::Constant(radiance), _) => {
                    far(cosine_direction(place.normal.as_dvec3(), pair).as_vec3(), PI * *radiance)
                }
            },
            1 => {
                let (sun, _) = light.sun.as_ref()?;
                let cap = Cap::of_sun(sun);
                let direction = world_from_environment * cap.sample(pair).as_vec3();
                far(direction, sun.radiance * (cap.solid_angle() as f32 * place.normal.dot(direction).max(0.0)))
            }
            _ => {
                let lamp = light.lights.get(number - 2)?;
                let cap = Cap::of(lamp, place.position);
                let direction = cap.sample(pair);
                let weight = cap.solid_angle() as f32 * place.normal.dot(direction.as_vec3()).max(0.0);
                let distance = Cap::distance(lamp, place.position, direction);
                Drawn { direction: direction.as_vec3(), arriving: lamp.radiance * weight, distance }
            }
        };
        (drawn.arriving != Vec3::ZERO).then_some(drawn)
    }
}
