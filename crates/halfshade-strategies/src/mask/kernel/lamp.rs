//! Lamps: suns and spherical lights, each a cap of constant radiance that is looked into in a few directions.
//!
//! Directions fill the cap evenly along a spiral of the golden angle. They are told from the lamp's middle by their difference,
//! since cosines of the small angles between them have no digits left.

use super::{
    cap::{Cap, edge_offset},
    directions::BLOCK,
};
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
    pub(crate) axis: Vec3,
    across: [Vec3; 2],
    /// 1 less the cosine of its angular radius.
    versine: f32,
    /// Distance of its centre; what lies farther hides nothing of it.
    pub(crate) distance: f32,
    /// 1 over the width of an edge.
    sharpness: f32,
    /// Chord from its middle up to which a cap may reach its edge and yet hide nothing.
    reach: f32,
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
        let (a, b) = axis.any_orthonormal_pair();
        let chord = (2.0 * versine).sqrt();
        Self { axis, across: [a, b], versine, distance, sharpness: 1.0 / (edge * radius), reach: chord + edge * radius }
    }

    /// Eight of its directions less its axis, along its own three axes; `within` as [`Spiral`] has it.
    #[inline(always)]
    pub(crate) fn shift(&self, within: f32x8, [cos, sin]: [f32x8; 2]) -> [f32x8; 3] {
        spread(self.versine, within, [cos, sin])
    }

    /// A vector along its axes, in light space.
    #[inline(always)]
    pub(crate) fn in_light_space(&self, [a, b, along]: &[f32x8; 3]) -> [f32x8; 3] {
        let [across_a, across_b, axis] = [self.across[0], self.across[1], self.axis].map(|v| v.to_array());
        std::array::from_fn(|k| {
            a.mul_add(f32x8::splat(across_a[k]), b.mul_add(f32x8::splat(across_b[k]), *along * f32x8::splat(axis[k])))
        })
    }

    /// Directions for what is known in cells of so small a versine only: those of a smaller lamp fill a cell.
    #[inline(always)]
    pub(crate) fn shift_over_cell(&self, least: f32, within: f32x8, turn: [f32x8; 2]) -> [f32x8; 3] {
        spread(self.versine.max(least), within, turn)
    }

    /// Takes from what is open of its directions, given by their `shifts`, what a cap closes; what is left may be less than
    /// nothing.
    #[inline(always)]
    pub(crate) fn close(&self, open: &mut [f32x8], shifts: &[[f32x8; 3]], cap: &Cap) {
        if cap.distance >= self.distance {
            return;
        }
        let axis = Vec3::from(cap.axis);
        let sine = 1.0 / axis.length();
        let offset = self.axis - sine * axis;
        let versine = sine / (1.0 / sine + cap.cotangent);
        if offset.length() > (2.0 * versine).sqrt() + self.reach {
            return;
        }
        let half_tangent = f32x8::splat(1.0 / (1.0 / sine + cap.cotangent));
        let rest = f32x8::ONE - edge_offset(half_tangent, f32x8::splat(self.sharpness));
        let along = [self.across[0], self.across[1], self.axis].map(|axis| f32x8::splat(axis.dot(offset)));
        // (cos Δ - cos θ) / sin θ, of which half a squared chord is 1 - cos Δ.
        let (level, slope) = (f32x8::splat(versine / sine), f32x8::splat(0.5 / sine));
        let sharpness = f32x8::splat(self.sharpness);
        for (open, shift) in open.iter_mut().zip(shifts) {
            let [a, b, c]: [f32x8; 3] = std::array::from_fn(|k| along[k] + shift[k]);
            let chord_squared = a.mul_add(a, b.mul_add(b, c * c));
            let inside = chord_squared.mul_neg_add(slope, level);
            *open = open.fast_min(inside.mul_neg_add(sharpness, rest));
        }
    }
}

/// Directions of a cap of this versine less its axis.
#[inline(always)]
fn spread(versine: f32, within: f32x8, [cos, sin]: [f32x8; 2]) -> [f32x8; 3] {
    let fall = within * f32x8::splat(versine);
    let across = (fall * (f32x8::splat(2.0) - fall)).fast_max(f32x8::ZERO).sqrt();
    [across * cos, across * sin, -fall]
}
