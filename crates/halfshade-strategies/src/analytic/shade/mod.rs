//! Receivers, eight at a time.

use super::{
    kernel::{hemisphere::hidden_of_sky, overlap::hidden_of_cap},
    prepare::frame::FrameData,
};
use crate::shared::{
    blockers::BlockingSphere,
    irradiance::Irradiance,
    placed_lamps::{Lamp, LampPlace},
    vector::dot,
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_strategy::Prepared;
use std::{f32::consts::PI, ops::Range};
use wide::f32x8;

/// A frame ready to be shaded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shader<'a> {
    pub(crate) frame: &'a FrameData,
    /// Irradiance of everything but lamps.
    pub(crate) rest: &'a Irradiance,
    /// Whether receivers see the spheres of their own object.
    pub(crate) sees_own: bool,
}

/// Eight receivers in light space.
struct Receivers8 {
    position: [f32x8; 3],
    normal: [f32x8; 3],
    object: f32x8,
}

/// Eight receivers' view of a lamp, and the part of it that is left.
#[derive(Clone, Copy)]
struct Lamp8 {
    axis: [f32x8; 3],
    angular_radius: f32x8,
    distance: f32x8,
    seen: f32x8,
}

impl Prepared for Shader<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let mut lamps = Vec::with_capacity(self.frame.lamps.len());
        for start in (0..receivers.len()).step_by(8) {
            self.shade_eight(receivers, start..(start + 8).min(receivers.len()), &mut lamps, &mut out);
        }
    }
}

impl Shader<'_> {
    /// Shades at most eight receivers. What one gets depends on itself alone.
    fn shade_eight(
        &self,
        receivers: Receivers<'_>,
        range: Range<usize>,
        lamps: &mut Vec<Lamp8>,
        out: &mut RadianceMut<'_>,
    ) {
        let space = &self.frame.space;
        // The last of fewer than eight fills up the rest.
        let number = |lane: usize| (range.start + lane).min(range.end - 1);
        let places: [Vec3; 8] = std::array::from_fn(|lane| space.point(receivers.position_at(number(lane)).as_dvec3()));
        let normals: [Vec3; 8] = std::array::from_fn(|lane| space.direction(receivers.normal_at(number(lane))));
        let eight = Receivers8 {
            position: std::array::from_fn(|axis| f32x8::from(places.map(|place| place[axis]))),
            normal: std::array::from_fn(|axis| f32x8::from(normals.map(|normal| normal[axis]))),
            object: f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| receivers.object[number(lane)] as f32)),
        };
        lamps.clear();
        lamps.extend(self.frame.lamps.iter().map(|lamp| Lamp8::new(lamp, &eight)));
        let sky = self.hide(&eight, lamps).to_array();
        for (lane, i) in range.enumerate() {
            let mut irradiance = sky[lane] * self.rest.at(normals[lane]);
            for (lamp, view) in self.frame.lamps.iter().zip(lamps.iter()) {
                irradiance += view.seen.to_array()[lane] * lamp.irradiance(places[lane], normals[lane]);
            }
            out.set(i, receivers.albedo_at(i) * irradiance / PI);
        }
    }

    /// The part of the sky that is left; the parts of the lamps are left in them.
    fn hide(&self, eight: &Receivers8, lamps: &mut [Lamp8]) -> f32x8 {
        let mut sky = f32x8::ONE;
        for &BlockingSphere { center, radius, object } in &self.frame.spheres {
            let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(center[axis]) - eight.position[axis]);
            let distance = dot(&offset, &offset).sqrt();
            let per_distance = f32x8::ONE / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
            let axis = offset.map(|value| value * per_distance);
            let mut sine = (f32x8::splat(radius) * per_distance).fast_min(f32x8::ONE);
            if !self.sees_own {
                sine = eight.object.simd_eq(f32x8::splat(object as f32)).select(f32x8::ZERO, sine);
            }
            sky *= f32x8::ONE - hidden_of_sky(dot(&axis, &eight.normal), sine);
            for lamp in lamps.iter_mut() {
                lamp.hide(&axis, sine, distance);
            }
        }
        sky
    }
}

impl Lamp8 {
    fn new(lamp: &Lamp, eight: &Receivers8) -> Self {
        match lamp.place {
            LampPlace::Far { direction, sine } => Self {
                axis: direction.map(f32x8::splat),
                angular_radius: f32x8::splat(sine.asin()),
                distance: f32x8::splat(f32::INFINITY),
                seen: f32x8::ONE,
            },
            LampPlace::Near { center, radius } => {
                let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(center[axis]) - eight.position[axis]);
                let distance = dot(&offset, &offset).sqrt();
                let per_distance = f32x8::ONE / distance.fast_max(f32x8::splat(f32::MIN_POSITIVE));
                // Within a light it is all around: the hemisphere above stands for it.
                let is_within = distance.simd_le(f32x8::splat(radius));
                let axis = |k: usize| is_within.select(eight.normal[k], offset[k] * per_distance);
                Self {
                    axis: std::array::from_fn(axis),
                    angular_radius: (f32x8::splat(radius) * per_distance).fast_min(f32x8::ONE).asin(),
                    distance: distance.fast_max(f32x8::splat(radius)),
                    seen: f32x8::ONE,
                }
            }
        }
    }

    /// Takes away what a cap hides of what is left.
    #[inline(always)]
    fn hide(&mut self, axis: &[f32x8; 3], sine: f32x8, distance: f32x8) {
        let is_before = distance.simd_lt(self.distance) & sine.simd_gt(f32x8::ZERO);
        let part = |sign: f32| {
            let between: [f32x8; 3] = std::array::from_fn(|k| f32x8::splat(sign).mul_add(axis[k], self.axis[k]));
            dot(&between, &between).sqrt()
        };
        // The angle between unit vectors a and b is 2 atan2(|a - b|, |a + b|), small or large.
        let apart = part(-1.0).atan2(part(1.0)) * f32x8::splat(2.0);
        let cap = sine.atan2(((f32x8::ONE - sine) * (f32x8::ONE + sine)).sqrt());
        let may_hide = is_before & apart.simd_lt(cap + self.angular_radius);
        if may_hide.any() {
            let hidden = hidden_of_cap(self.angular_radius, cap, apart);
            self.seen *= may_hide.select(f32x8::ONE - hidden, f32x8::ONE);
        }
    }
}
