//! The spheres that block [Meunier2009, 5.3]: those of a frame, those that may be in the way of a light, and what one
//! receiver sees of eight of them.

use glam::{DVec3, Vec3};
use halfshade_scene::{
    Frame, Object, Scene, Sphere, SphereSet,
    spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT, SphereBinding},
};
use std::sync::Arc;
use wide::f32x8;

/// The sphere set of an object, and how it follows the object's mesh if that deforms.
#[derive(Debug)]
pub(super) struct Body {
    set: Arc<SphereSet>,
    binding: Option<SphereBinding>,
}

/// Those of the objects that block, in the order of the scene's objects.
pub(super) fn bodies(scene: &Scene) -> Vec<Option<Body>> {
    let body = |object: &Object| {
        let set = object.spheres.as_ref().filter(|_| object.sphere_count > 0)?;
        let binding = object.skin.as_ref().map(|_| SphereBinding::new(&object.mesh, &set.spheres));
        Some(Body { set: set.clone(), binding })
    };
    scene.objects.iter().map(body).collect()
}

impl Body {
    fn spheres(&self, frame: &Frame<'_>, object: usize) -> Vec<Sphere> {
        match (&self.binding, frame.deformed(object)) {
            (Some(binding), Some(deformed)) => {
                let rest = &frame.scene.objects[object].mesh.positions;
                binding.follow(rest, &deformed.positions).into_iter().map(|followed| followed.sphere).collect()
            }
            _ => self.set.spheres.clone(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.binding.as_ref().map_or(0, SphereBinding::bytes)
    }
}

/// Spheres as a structure of arrays, filled up to whole groups of eight with spheres of no size.
#[derive(Debug, Clone, Default)]
pub(super) struct Spheres {
    center: [Vec<f32>; 3],
    radius: Vec<f32>,
}

impl Spheres {
    /// All of a frame, about `origin`.
    pub(super) fn of(frame: &Frame<'_>, bodies: &[Option<Body>], origin: DVec3) -> Self {
        let mut spheres = Self::default();
        for (object, (body, pose)) in bodies.iter().zip(&frame.world_from_object).enumerate() {
            let Some(body) = body else { continue };
            for sphere in body.spheres(frame, object) {
                let scaled = f64::from(pose.scale) * sphere.center.as_dvec3();
                let center = pose.rotation.as_dquat().normalize() * scaled + pose.translation.as_dvec3() - origin;
                spheres.push(center.as_vec3().to_array(), pose.scale * sphere.radius);
            }
        }
        spheres.fill_up();
        spheres
    }

    fn push(&mut self, center: [f32; 3], radius: f32) {
        self.center.iter_mut().zip(center).for_each(|(axis, value)| axis.push(value));
        self.radius.push(radius);
    }

    fn clear(&mut self) {
        self.center.iter_mut().for_each(Vec::clear);
        self.radius.clear();
    }

    fn fill_up(&mut self) {
        while !self.radius.len().is_multiple_of(8) {
            self.push([0.0; 3], 0.0);
        }
    }

    pub(super) fn bytes(&self) -> usize {
        4 * size_of_val(self.radius.as_slice())
    }

    /// A ball around all of them.
    pub(super) fn ball(&self) -> Ball {
        if self.radius.is_empty() {
            return Ball { center: [0.0; 3], radius: 0.0 };
        }
        let [x, y, z] = &self.center;
        let centers: Vec<[f32; 3]> = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect();
        let ball = Ball::around(&centers);
        Ball { radius: ball.radius + self.radius.iter().copied().fold(0.0, f32::max), ..ball }
    }

    #[cfg(test)]
    pub(super) fn from_balls(balls: &[Ball]) -> Self {
        let mut spheres = Self::default();
        balls.iter().for_each(|ball| spheres.push(ball.center, ball.radius));
        spheres.fill_up();
        spheres
    }

    /// Groups of eight: centres and radii.
    #[inline(always)]
    pub(super) fn groups(&self) -> impl Iterator<Item = ([f32x8; 3], f32x8)> {
        let load =
            |values: &[f32], start: usize| f32x8::from(values[start..].first_chunk::<8>().copied().unwrap_or_default());
        (0..self.radius.len())
            .step_by(8)
            .map(move |start| (std::array::from_fn(|axis| load(&self.center[axis], start)), load(&self.radius, start)))
    }

    /// Replaces `kept` by those that meet the hull of two balls, receivers and a light: no other is in the way of any
    /// receiver, and the order stays, so that how receivers are grouped changes no bit.
    pub(super) fn keep_between(&self, receivers: &Ball, light: &Ball, kept: &mut Self) {
        kept.clear();
        let to_light: [f32; 3] = std::array::from_fn(|axis| light.center[axis] - receivers.center[axis]);
        let squared: f32 = to_light.iter().map(|x| x * x).sum();
        let length = squared.sqrt();
        let growth = light.radius - receivers.radius;
        // One ball within the other: their hull is the larger one, which a capsule of its radius contains.
        let (slope, growth, start) = if length > growth.abs() * 1.001 {
            (growth / (squared * (1.0 - growth * growth / squared).sqrt()), growth, receivers.radius)
        } else {
            (0.0, 0.0, receivers.radius.max(light.radius))
        };
        let inverse = f32x8::splat(squared.max(f32::MIN_POSITIVE).recip());
        let [lx, ly, lz] = to_light.map(f32x8::splat);
        let slack = f32x8::splat(1e-4 * (length + light.radius + receivers.radius));
        for (group, (center, radius)) in self.groups().enumerate() {
            let [x, y, z]: [f32x8; 3] = std::array::from_fn(|axis| center[axis] - f32x8::splat(receivers.center[axis]));
            let along = lx.mul_add(x, ly.mul_add(y, lz * z)) * inverse;
            let distance_squared = |place: f32x8| {
                let [x, y, z] = [place.mul_neg_add(lx, x), place.mul_neg_add(ly, y), place.mul_neg_add(lz, z)];
                x.mul_add(x, y.mul_add(y, z * z))
            };
            // Where the hull's surface is nearest: moved towards the wider end.
            let aside = distance_squared(along).sqrt();
            let place = aside.mul_add(f32x8::splat(slope), along).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            let reach = place.mul_add(f32x8::splat(growth), f32x8::splat(start)) + radius + slack;
            let near = distance_squared(place).simd_le(reach * reach) & radius.simd_gt(f32x8::ZERO);
            let mut bits = near.to_bitmask();
            while bits != 0 {
                let i = 8 * group + bits.trailing_zeros() as usize;
                kept.push(self.center.each_ref().map(|axis| axis[i]), self.radius[i]);
                bits &= bits - 1;
            }
        }
        kept.fill_up();
    }
}

/// A ball about the origin of the frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub(super) center: [f32; 3],
    pub(super) radius: f32,
}

impl Ball {
    /// How far its surface is from within it in the directions of eight points, all from one place.
    #[inline(always)]
    pub(super) fn surface_behind(&self, offset: &[f32x8; 3]) -> f32x8 {
        let dot = |a: &[f32x8; 3], b: &[f32x8; 3]| a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]));
        let center = self.center.map(f32x8::splat);
        let distance = dot(offset, offset).fast_max(f32x8::splat(f32::MIN_POSITIVE)).sqrt();
        let along = dot(&center, offset) / distance;
        let depth = f32x8::splat(self.radius * self.radius) - dot(&center, &center);
        along + along.mul_add(along, depth).fast_max(f32x8::ZERO).sqrt()
    }

    /// Around points.
    pub(super) fn around(points: &[[f32; 3]]) -> Self {
        let points = || points.iter().map(|&point| Vec3::from(point));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let high = points().fold(Vec3::NEG_INFINITY, Vec3::max);
        let center = 0.5 * (low + high);
        let radius = points().map(|point| point.distance(center)).fold(0.0, f32::max);
        Self { center: center.to_array(), radius }
    }
}

/// A point of a surface, in the frame of the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Receiver {
    pub(super) position: [f32; 3],
    pub(super) normal: [f32; 3],
}

impl Receiver {
    /// What it sees of eight spheres: offsets of centres and radii, after the rules of [`halfshade_scene::spheres::adjust`],
    /// of which this is the branch-free single-precision twin. A radius of 0 has no influence.
    #[inline(always)]
    pub(super) fn adjusted(&self, center: &[f32x8; 3], radius: f32x8, rule: AdjustRule) -> ([f32x8; 3], f32x8) {
        let dot = |a: &[f32x8; 3], b: &[f32x8; 3]| a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]));
        let normal = self.normal.map(f32x8::splat);
        let offset: [f32x8; 3] = std::array::from_fn(|axis| center[axis] - f32x8::splat(self.position[axis]));
        let height = dot(&offset, &normal);
        let cut = height.simd_lt(radius);
        if !cut.any() {
            return (offset, radius);
        }
        let front = ((radius + height) * f32x8::splat(0.5)).fast_max(f32x8::ZERO).fast_min(radius);
        let foot: [f32x8; 3] = std::array::from_fn(|axis| height.mul_neg_add(normal[axis], offset[axis]));
        let floor = (radius * radius * f32x8::splat(1e-12)).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let cut_squared = ((radius - height) * (radius + height)).fast_max(floor);
        let relative = (dot(&foot, &foot) / cut_squared).sqrt();
        let per_height =
            |share: f64| height / (f32x8::splat(share as f32) * radius).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let in_front = match rule {
            AdjustRule::Continuous => per_height(FADE_HEIGHT),
            AdjustRule::Covering => per_height(COVER_HEIGHT),
            AdjustRule::Published => height.simd_ge(f32x8::ZERO).select(f32x8::ONE, f32x8::ZERO),
        }
        .fast_max(f32x8::ZERO)
        .fast_min(f32x8::ONE);
        let scale = (relative - f32x8::ONE).fast_max(in_front).fast_min(f32x8::ONE);
        let lift = height.fast_max(front) - height;
        let pull = match rule {
            AdjustRule::Covering => in_front * (f32x8::ONE - relative.fast_min(f32x8::ONE)),
            AdjustRule::Continuous | AdjustRule::Published => f32x8::ZERO,
        };
        let moved: [f32x8; 3] =
            std::array::from_fn(|axis| pull.mul_neg_add(foot[axis], lift.mul_add(normal[axis], offset[axis])));
        // Spheres that the plane doesn't cut stay what they are, to the bit, whoever their neighbours are.
        (std::array::from_fn(|axis| cut.select(moved[axis], offset[axis])), cut.select(scale * front, radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::random;
    use halfshade_scene::spheres::adjust;

    #[test]
    fn spheres_are_adjusted_as_in_double_precision() {
        let mut random = random(1);
        let (mut seen, mut hidden) = (0, 0);
        for _ in 0..2_000 {
            let normal = Vec3::new(random(), random(), random()).normalize_or(Vec3::Y);
            let receiver = Receiver { position: std::array::from_fn(|_| random()), normal: normal.to_array() };
            let center: [[f32; 8]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * random()));
            let radius: [f32; 8] = std::array::from_fn(|_| 0.05 + random().abs());
            for rule in [AdjustRule::Continuous, AdjustRule::Covering, AdjustRule::Published] {
                let (offset, adjusted) = receiver.adjusted(&center.map(f32x8::from), f32x8::from(radius), rule);
                for lane in 0..8 {
                    let from_receiver =
                        DVec3::from_array(std::array::from_fn(|i| f64::from(center[i][lane] - receiver.position[i])));
                    let sine = |offset: DVec3, radius: f64| (radius / offset.length()).min(1.0);
                    let found = DVec3::from(offset.map(|axis| f64::from(axis.to_array()[lane])));
                    let found_sine = sine(found, f64::from(adjusted.to_array()[lane]));
                    match adjust(rule, from_receiver, f64::from(radius[lane]), normal.as_dvec3().normalize()) {
                        Some(exact) => {
                            seen += 1;
                            assert!((exact.sin_angular_radius() - found_sine).abs() < 2e-3);
                            assert!(found.distance(exact.offset) < 1e-4 || found_sine < 1e-3);
                        }
                        None => {
                            hidden += 1;
                            assert!(found_sine < 1e-3, "{found_sine}");
                        }
                    }
                }
            }
        }
        assert!(seen > 5_000 && hidden > 5_000);
    }

    /// Sampled balls of the hull: whoever meets one of them is kept.
    #[test]
    fn nobody_in_the_way_is_left_out() {
        let mut random = random(2);
        let (mut kept_count, mut met_count) = (0, 0);
        for _ in 0..200 {
            let mut ball =
                |size: f32| Ball { center: std::array::from_fn(|_| 3.0 * random()), radius: size * random().abs() };
            let (receivers, light) = (ball(1.0), ball(3.0));
            let mut all = Spheres::default();
            (0..40).map(|_| ball(0.3)).for_each(|ball| all.push(ball.center, ball.radius));
            let mut kept = Spheres::default();
            all.keep_between(&receivers, &light, &mut kept);
            assert!(kept.radius.len().is_multiple_of(8));
            kept_count += kept.radius.iter().filter(|radius| **radius > 0.0).count();
            for i in 0..40 {
                let center = Vec3::from(all.center.each_ref().map(|axis| axis[i]));
                let meets = (0..=100).any(|step| {
                    let t = step as f32 / 100.0;
                    let place = Vec3::from(receivers.center).lerp(light.center.into(), t);
                    let radius = receivers.radius + t * (light.radius - receivers.radius);
                    place.distance(center) < radius + all.radius[i]
                });
                let is_kept = kept.radius.contains(&all.radius[i]);
                met_count += usize::from(meets);
                assert!(is_kept || !meets);
            }
        }
        assert!(met_count > 500 && kept_count < met_count * 11 / 10 + 50, "{kept_count} {met_count}");
    }
}
