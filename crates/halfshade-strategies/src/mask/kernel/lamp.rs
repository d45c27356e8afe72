//! Lamps: suns and spherical lights, each a cap of constant radiance that is looked into in a few directions, which fill it
//! evenly along a spiral of the golden angle.

use super::{bundle::Bundle, cap::Cap, directions::BLOCK};
use crate::shared::placed_lamps::LampPlace;
use glam::Vec3;
use halfshade_sh::quadrature::GOLDEN_ANGLE;
use wide::f32x8;

/// Places on a cap, the same for all: the part of its solid angle that lies nearer to its middle, and the unit vector
/// around it.
#[derive(Debug, Clone)]
pub(crate) struct Spiral {
    /// Part within, eight by eight.
    pub(crate) within: Vec<f32x8>,
    /// Cosine and sine of the turn.
    pub(crate) turn: Vec<[f32x8; 2]>,
    /// How many there are; the last lanes fill up.
    pub(crate) count: usize,
}

/// A lamp as one receiver sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LampView {
    pub(crate) bundle: Bundle,
    /// 1 less the cosine of its angular radius.
    pub(crate) versine: f32,
    sine: f32,
    /// 1 over the width of an edge.
    pub(crate) sharpness: f32,
    /// Whether the receiver lies within the light.
    pub(crate) is_all_around: bool,
}

impl Spiral {
    /// So many places, in whole blocks.
    pub(crate) fn new(count: usize) -> Self {
        let lanes = |first: usize, of: &dyn Fn(f64) -> f64| {
            f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| of((first + lane) as f64) as f32))
        };
        let firsts = (0..count.next_multiple_of(8 * BLOCK)).step_by(8);
        Self {
            within: firsts.clone().map(|first| lanes(first, &|i| ((i + 0.5) / count as f64).min(1.0))).collect(),
            turn: firsts
                .map(|first| {
                    [f64::cos, f64::sin].map(|of| lanes(first, &|i| of((GOLDEN_ANGLE * i) % std::f64::consts::TAU)))
                })
                .collect(),
            count,
        }
    }

    /// 1 for places, 0 for what fills up the last lanes, of eight from `first` on.
    #[inline(always)]
    pub(crate) fn counts(&self, first: usize) -> f32x8 {
        f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| if first + lane < self.count { 1.0 } else { 0.0 }))
    }
}

impl LampView {
    /// From `position` on a surface with unit `normal`. Within a light it is all around: then it is the hemisphere above.
    pub(crate) fn new(place: &LampPlace, position: Vec3, normal: Vec3, edge: f32, count: usize) -> Self {
        let (axis, sine, distance) = match *place {
            LampPlace::Far { direction, sine } => (Vec3::from(direction), sine, f32::INFINITY),
            LampPlace::Near { center, radius } => {
                let offset = Vec3::from(center) - position;
                let distance = offset.length();
                if distance > radius { (offset / distance, radius / distance, distance) } else { (normal, 1.0, radius) }
            }
        };
        let versine = sine * sine / (1.0 + (1.0 - sine * sine).max(0.0).sqrt());
        // A disc of a place's solid angle.
        let radius = (2.0 * versine / count as f32).sqrt().max(1e-18);
        let sharpness = 1.0 / (edge * radius);
        let bundle = Bundle::new(axis, distance, sharpness, [(2.0 * versine).sqrt(), edge * radius]);
        let is_all_around = matches!(*place, LampPlace::Near { radius, .. } if distance <= radius);
        Self { bundle, versine, sine, sharpness, is_all_around }
    }

    /// Eight of its directions less its axis, along the bundle's axes; `within` as [`Spiral`] has it. For what is known in
    /// cells of a versine only, those of a smaller lamp fill a cell of this `least` one.
    #[inline(always)]
    pub(crate) fn shift(&self, least: f32, within: f32x8, [cos, sin]: [f32x8; 2]) -> [f32x8; 3] {
        let fall = within * f32x8::splat(self.versine.max(least));
        let across = (fall * (f32x8::splat(2.0) - fall)).fast_max(f32x8::ZERO).sqrt();
        [across * cos, across * sin, -fall]
    }

    /// It as a cap that hides what is behind it, at no distance; `None` if it is a point.
    pub(crate) fn cap(&self) -> Option<Cap> {
        let axis = (self.bundle.axis / self.sine).to_array();
        let cotangent = ((1.0 - self.sine) * (1.0 + self.sine)).max(0.0).sqrt() / self.sine;
        (self.sine > 1e-7).then_some(Cap { axis, cotangent, offset: 0.0, distance: 0.0 })
    }
}
