//! The spheres that block [Meunier2009, 5.3]: those of a frame, those that may be in the way of a light, and what one
//! receiver sees of eight of them.

use crate::shared::{tangent_plane::OverPlane, vector::dot};
use glam::{DVec3, Vec3};
use halfshade_scene::{
    Frame, Object, Pose, Scene, Sphere, SphereSet,
    spheres::{AdjustRule, SphereBinding},
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

/// Centres and radii in world space of all spheres of a frame.
pub(super) fn placed_spheres(frame: &Frame<'_>, bodies: &[Option<Body>]) -> Vec<(DVec3, f32)> {
    let of_object = |(object, (body, pose)): (usize, (&Option<Body>, &Pose))| -> Vec<(DVec3, f32)> {
        let rotation = pose.rotation.as_dquat().normalize();
        let placed = |sphere: Sphere| {
            let center = rotation * (f64::from(pose.scale) * sphere.center.as_dvec3()) + pose.translation.as_dvec3();
            (center, pose.scale * sphere.radius)
        };
        body.iter().flat_map(|body| body.spheres(frame, object)).map(placed).collect()
    };
    bodies.iter().zip(&frame.world_from_object).enumerate().flat_map(of_object).collect()
}

/// Spheres as a structure of arrays, filled up to whole groups of eight with spheres of no size.
#[derive(Debug, Clone, Default)]
pub(super) struct Spheres {
    center: [Vec<f32>; 3],
    radius: Vec<f32>,
}

impl Spheres {
    /// Centres, taken about `origin`, and radii.
    pub(super) fn about(origin: DVec3, placed: &[(DVec3, f32)]) -> Self {
        let mut spheres = Self::default();
        placed.iter().for_each(|(center, radius)| spheres.push((*center - origin).as_vec3().to_array(), *radius));
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
    /// What it sees of eight spheres: offsets of centres and radii, after the rules of [`halfshade_scene::spheres::adjust`].
    /// A radius of 0 has no influence.
    #[inline(always)]
    pub(super) fn adjusted(&self, center: &[f32x8; 3], radius: f32x8, rule: AdjustRule) -> ([f32x8; 3], f32x8) {
        let offset: [f32x8; 3] = std::array::from_fn(|axis| center[axis] - f32x8::splat(self.position[axis]));
        let over = OverPlane::new(offset, radius, self.normal.map(f32x8::splat));
        if !over.is_cut().any() {
            return (offset, radius);
        }
        // Groups are filled up with spheres of no size.
        let relative_height = over.height / radius.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        over.adjusted(rule, relative_height).unwrap_or((offset, f32x8::ZERO))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

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
