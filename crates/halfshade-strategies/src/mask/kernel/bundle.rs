//! A bundle of directions about an axis, which lamps and lobes are looked into along.
//!
//! Directions are told from the axis by their difference, since cosines of the small angles between them have no digits left.

use super::cap::{Cap, edge_offset};
use glam::Vec3;
use wide::f32x8;

/// The bundle of one receiver.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bundle {
    pub(crate) axis: Vec3,
    across: [Vec3; 2],
    /// Distance from which on nothing is hidden.
    pub(crate) distance: f32,
    /// Mean of 1 over the width of an edge.
    sharpness: f32,
    /// Chord from the axis up to which a cap may reach its edge and yet hide nothing.
    reach: f32,
}

impl Bundle {
    /// About unit `axis`; `chord` is that of its outermost direction, whose edge is `edge` wide.
    pub(crate) fn new(axis: Vec3, distance: f32, sharpness: f32, [chord, edge]: [f32; 2]) -> Self {
        let (a, b) = axis.any_orthonormal_pair();
        Self { axis, across: [a, b], distance, sharpness, reach: chord + edge }
    }

    /// A vector along its axes, in light space.
    #[inline(always)]
    pub(crate) fn in_light_space(&self, [a, b, along]: &[f32x8; 3]) -> [f32x8; 3] {
        let [across_a, across_b, axis] = [self.across[0], self.across[1], self.axis].map(|v| v.to_array());
        std::array::from_fn(|k| {
            a.mul_add(f32x8::splat(across_a[k]), b.mul_add(f32x8::splat(across_b[k]), *along * f32x8::splat(axis[k])))
        })
    }

    /// Directions that differ so from the axis.
    #[inline(always)]
    pub(crate) fn directions(&self, shift: &[f32x8; 3]) -> [f32x8; 3] {
        let (shift, axis) = (self.in_light_space(shift), self.axis.to_array());
        std::array::from_fn(|k| f32x8::splat(axis[k]) + shift[k])
    }

    /// Half the squared chords from a unit vector to directions: 1 less their cosine.
    #[inline(always)]
    pub(crate) fn versines_to(&self, unit: Vec3, shift: &[f32x8; 3]) -> f32x8 {
        let along = self.along(self.axis - unit);
        let [a, b, c]: [f32x8; 3] = std::array::from_fn(|k| along[k] + shift[k]);
        a.mul_add(a, b.mul_add(b, c * c)) * f32x8::HALF
    }

    /// A vector of light space along its axes.
    #[inline(always)]
    fn along(&self, vector: Vec3) -> [f32x8; 3] {
        [self.across[0], self.across[1], self.axis].map(|axis| f32x8::splat(axis.dot(vector)))
    }

    /// Takes from what is open of its directions, given by their `shifts` and the `sharpness` of their cells, what a cap closes;
    /// what is left may be less than nothing.
    #[inline(always)]
    pub(crate) fn close(&self, open: &mut [f32x8], shifts: &[[f32x8; 3]], sharpness: &[f32x8], cap: &Cap) {
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
        let along = self.along(offset);
        // (cos Δ - cos θ) / sin θ, of which half a squared chord is 1 - cos Δ.
        let (level, slope) = (f32x8::splat(versine / sine), f32x8::splat(0.5 / sine));
        for ((open, shift), sharpness) in open.iter_mut().zip(shifts).zip(sharpness) {
            let [a, b, c]: [f32x8; 3] = std::array::from_fn(|k| along[k] + shift[k]);
            let chord_squared = a.mul_add(a, b.mul_add(b, c * c));
            let inside = chord_squared.mul_neg_add(slope, level);
            *open = open.fast_min(inside.mul_neg_add(*sharpness, rest));
        }
    }
}
