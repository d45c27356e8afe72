//! Spheres that block [Meunier2009, 5.3] as a structure of arrays, and those of them that may be in the way of a light.

use crate::shared::vector::dot;
use glam::{DVec3, Vec3};
use wide::f32x8;

/// Spheres as a structure of arrays, filled up to whole groups of eight with spheres of no size.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spheres {
    center: [Vec<f32>; 3],
    radius: Vec<f32>,
}

impl Spheres {
    /// Centres, taken about `origin`, and radii.
    pub(crate) fn about(origin: DVec3, placed: &[(DVec3, f32)]) -> Self {
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

    pub(crate) fn bytes(&self) -> usize {
        4 * size_of_val(self.radius.as_slice())
    }

    /// The bounding sphere of all of them.
    pub(crate) fn bounds(&self) -> BoundingSphere {
        if self.radius.is_empty() {
            return BoundingSphere { center: [0.0; 3], radius: 0.0 };
        }
        let [x, y, z] = &self.center;
        let centers: Vec<[f32; 3]> = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect();
        let bounds = BoundingSphere::around(&centers);
        BoundingSphere { radius: bounds.radius + self.radius.iter().copied().fold(0.0, f32::max), ..bounds }
    }

    #[cfg(test)]
    pub(crate) fn from_list(list: &[BoundingSphere]) -> Self {
        let mut spheres = Self::default();
        list.iter().for_each(|sphere| spheres.push(sphere.center, sphere.radius));
        spheres.fill_up();
        spheres
    }

    /// Groups of eight: centres and radii.
    #[inline(always)]
    pub(crate) fn groups(&self) -> impl Iterator<Item = ([f32x8; 3], f32x8)> {
        let load =
            |values: &[f32], start: usize| f32x8::from(values[start..].first_chunk::<8>().copied().unwrap_or_default());
        (0..self.radius.len())
            .step_by(8)
            .map(move |start| (std::array::from_fn(|axis| load(&self.center[axis], start)), load(&self.radius, start)))
    }

    /// Replaces `kept` by those that meet the hull of two spheres, around receivers and a light: no other is in the way of any
    /// receiver, and the order stays, so that how receivers are grouped changes no bit.
    pub(crate) fn keep_between(&self, receivers: &BoundingSphere, light: &BoundingSphere, kept: &mut Self) {
        kept.clear();
        let to_light: [f32; 3] = std::array::from_fn(|axis| light.center[axis] - receivers.center[axis]);
        let squared: f32 = to_light.iter().map(|x| x * x).sum();
        let length = squared.sqrt();
        let growth = light.radius - receivers.radius;
        // One sphere within the other: their hull is the larger one, which a capsule of its radius contains.
        let (slope, growth, start) = if length > growth.abs() * 1.001 {
            (growth / (squared * (1.0 - growth * growth / squared).sqrt()), growth, receivers.radius)
        } else {
            (0.0, 0.0, receivers.radius.max(light.radius))
        };
        let inverse = f32x8::splat(squared.max(f32::MIN_POSITIVE).recip());
        let to_light8 = to_light.map(f32x8::splat);
        let slack = f32x8::splat(1e-4 * (length + light.radius + receivers.radius));
        for (group, (center, radius)) in self.groups().enumerate() {
            let offset: [f32x8; 3] = std::array::from_fn(|axis| center[axis] - f32x8::splat(receivers.center[axis]));
            let along = dot(&to_light8, &offset) * inverse;
            let distance_squared = |place: f32x8| {
                let aside: [f32x8; 3] = std::array::from_fn(|axis| place.mul_neg_add(to_light8[axis], offset[axis]));
                dot(&aside, &aside)
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

/// A bounding sphere about the origin of the frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundingSphere {
    pub(crate) center: [f32; 3],
    pub(crate) radius: f32,
}

impl BoundingSphere {
    /// How far its surface is from within it in the directions of eight points, all from one place.
    #[inline(always)]
    pub(crate) fn surface_behind(&self, offset: &[f32x8; 3]) -> f32x8 {
        let center = self.center.map(f32x8::splat);
        let distance = dot(offset, offset).fast_max(f32x8::splat(f32::MIN_POSITIVE)).sqrt();
        let along = dot(&center, offset) / distance;
        let depth = f32x8::splat(self.radius * self.radius) - dot(&center, &center);
        along + along.mul_add(along, depth).fast_max(f32x8::ZERO).sqrt()
    }

    /// The bounding sphere of points.
    pub(crate) fn around(points: &[[f32; 3]]) -> Self {
        let points = || points.iter().map(|&point| Vec3::from(point));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let high = points().fold(Vec3::NEG_INFINITY, Vec3::max);
        let center = 0.5 * (low + high);
        let radius = points().map(|point| point.distance(center)).fold(0.0, f32::max);
        Self { center: center.to_array(), radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    /// Sampled spheres of the hull: whoever meets one of them is kept.
    #[test]
    fn nobody_in_the_way_is_left_out() {
        let mut random = random(2);
        let (mut kept_count, mut met_count) = (0, 0);
        for _ in 0..200 {
            let mut sphere = |size: f32| BoundingSphere {
                center: std::array::from_fn(|_| 3.0 * random()),
                radius: size * random().abs(),
            };
            let (receivers, light) = (sphere(1.0), sphere(3.0));
            let mut all = Spheres::default();
            (0..40).map(|_| sphere(0.3)).for_each(|sphere| all.push(sphere.center, sphere.radius));
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
