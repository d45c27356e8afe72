//! The caps as which receivers see spheres.

use crate::shared::{blockers::BlockingSphere, tangent_plane::OverPlane, vector::dot};
use halfshade_scene::spheres::AdjustRule;
use wide::f32x8;

/// Sines of angular radii below this hide nothing that single precision could tell.
const SMALLEST_SINE: f32 = 1e-7;

/// Cotangent of a cap that hides nothing.
const NOTHING: f32 = 1e30;

/// Eight receivers in light space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receivers8 {
    pub(crate) position: [f32x8; 3],
    /// Unit.
    pub(crate) normal: [f32x8; 3],
    /// Objects whose own spheres they don't see; -1: there is none.
    pub(crate) without: f32x8,
    /// Mean sharpness of the directions that they look into.
    pub(crate) sharpness: f32x8,
}

/// One sphere as eight receivers see it after the rules of [`halfshade_scene::spheres::adjust`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cap8 {
    axis: [[f32; 8]; 3],
    cotangent: [f32; 8],
    offset: [f32; 8],
    distance: [f32; 8],
}

/// The same of one receiver.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cap {
    /// Unit direction to the middle over the sine of the angular radius.
    pub(crate) axis: [f32; 3],
    /// Cotangent of the angular radius.
    pub(crate) cotangent: f32,
    /// Part of a direction's cell that is closed at the edge.
    pub(crate) offset: f32,
    /// Distance of the sphere's centre.
    pub(crate) distance: f32,
}

impl Cap8 {
    /// The view of `receivers` on a sphere; `None` if none of the eight sees anything.
    #[inline(always)]
    pub(crate) fn new(sphere: &BlockingSphere, receivers: &Receivers8, rule: AdjustRule) -> Option<Self> {
        let Receivers8 { position, normal, without, sharpness } = receivers;
        let radius = f32x8::splat(sphere.radius);
        let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(sphere.center[axis]) - position[axis]);
        let over = OverPlane::new(offset, radius, *normal);
        let (moved, reach) = if over.is_cut().any() {
            over.adjusted(rule, over.height * f32x8::splat(1.0 / sphere.radius))?
        } else {
            (offset, radius)
        };
        let distance = dot(&moved, &moved).sqrt();
        let is_seen = reach.simd_gt(distance * f32x8::splat(SMALLEST_SINE))
            & !without.simd_eq(f32x8::splat(sphere.object as f32));
        if is_seen.none() {
            return None;
        }
        let per_reach = f32x8::ONE / is_seen.select(reach, f32x8::ONE);
        let axis = moved.map(|value| is_seen.select(value * per_reach, f32x8::ZERO));
        // 1/sin² is at least 1.
        let per_sine_squared = dot(&axis, &axis);
        let cotangent = (per_sine_squared - f32x8::ONE).fast_max(f32x8::ZERO).sqrt();
        let cotangent = is_seen.select(cotangent, f32x8::splat(NOTHING));
        // tan(θ/2) = (1 - cos θ) / sin θ.
        let half_tangent = f32x8::ONE / (per_sine_squared.sqrt() + cotangent);
        Some(Self {
            axis: axis.map(f32x8::to_array),
            cotangent: cotangent.to_array(),
            offset: edge_offset(half_tangent, *sharpness).to_array(),
            distance: distance.to_array(),
        })
    }
}

/// The part of a cell that a cap's edge closes, by the tangent of half its angular radius, so that small caps hide their
/// solid angle.
#[inline(always)]
pub(crate) fn edge_offset(half_tangent: f32x8, sharpness: f32x8) -> f32x8 {
    let widths = ((half_tangent + half_tangent) * sharpness).fast_min(f32x8::ONE);
    widths.sqrt() - f32x8::HALF * widths
}

impl Cap8 {
    /// The cap of one receiver; `None` if it hides nothing.
    #[inline(always)]
    pub(crate) fn of(&self, lane: usize) -> Option<Cap> {
        let cotangent = self.cotangent[lane];
        (cotangent < NOTHING).then(|| Cap {
            axis: self.axis.map(|axis| axis[lane]),
            cotangent,
            offset: self.offset[lane],
            distance: self.distance[lane],
        })
    }
}
