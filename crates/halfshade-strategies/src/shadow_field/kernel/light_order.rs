//! The order of an object and a local light from eight receivers [Tamura2006, figure 3]: by the distances of their
//! centres, which say nothing where one is within the other.

use crate::shared::vector::dot;
use wide::f32x8;

/// How much of an object lies within a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Containment {
    /// Not even its centre.
    Outside,
    /// Its centre, but not all of it.
    Center,
    /// All of it.
    Whole,
}

/// Where eight receivers see a local light.
pub(crate) struct LightSeen {
    /// From the receiver to the light's centre.
    pub(crate) offset: [f32x8; 3],
    pub(crate) distance_squared: f32x8,
    /// Where it is all around, on its surface too: a mask.
    pub(crate) is_around: f32x8,
}

impl LightSeen {
    /// A light as seen from eight places.
    #[inline(always)]
    pub(crate) fn new(center: &[f32; 3], radius: f32, position: &[f32x8; 3]) -> Self {
        let offset = offset(center, position);
        let distance_squared = dot(&offset, &offset);
        let is_around = distance_squared.simd_le(f32x8::splat(radius * radius));
        Self { offset, distance_squared, is_around }
    }
}

/// From eight places to a point.
#[inline(always)]
fn offset(to: &[f32; 3], position: &[f32x8; 3]) -> [f32x8; 3] {
    std::array::from_fn(|axis| f32x8::splat(to[axis]) - position[axis])
}

/// Squared distance of a point from eight places.
#[inline(always)]
pub(crate) fn distance_squared(to: &[f32; 3], position: &[f32x8; 3]) -> f32x8 {
    let offset = offset(to, position);
    dot(&offset, &offset)
}

/// Whether an object with its centre at `center` is before a light, as a mask. Before a light that is all around is what
/// has its centre in it; from outside, nothing is that lies in the light as a whole.
#[inline(always)]
pub(crate) fn is_before(containment: Containment, center: &[f32; 3], seen: &LightSeen, position: &[f32x8; 3]) -> f32x8 {
    let from_outside = match containment {
        Containment::Whole => f32x8::ZERO,
        _ => distance_squared(center, position).simd_lt(seen.distance_squared),
    };
    match containment {
        Containment::Outside => seen.is_around.select(f32x8::ZERO, from_outside),
        _ => seen.is_around | from_outside,
    }
}
