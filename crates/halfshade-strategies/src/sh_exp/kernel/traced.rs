//! `exp=traced`: visibility of the spheres found ray by ray and projected, the floor under every way to combine blockers.
//!
//! No product and no exponential: along each of many directions, the nearest sphere that holds it is what is seen. What
//! this leaves of the error against the same spheres is due to the number of bands, and in reflections to what a sphere
//! is known to radiate; the rest of another variant's error is due to its products and its exponential. A diagnosis, not a
//! method to render with: it costs as many tests as directions times spheres.
//!
//! ```text
//! V = 1 - Σ_ω w Y(ω) [blocked]        Ṽ_i = Σ_ω w ρ̂_n(ω) [sphere i is nearest]
//! ```
//!
//! with ρ̂_n the clamped cosine over π in as many bands, and w = 4π over the number of directions.

use super::{Blockers, Receivers8, blocker::Seen, dot_shared};
use crate::shared::vector::dot;
use glam::DVec3;
use halfshade_sh::kernel::{self, ShBatch};
use wide::f32x8;

/// Directions, and memory for one batch of receivers.
pub(crate) struct Traced<const N: usize> {
    /// Unit, in light space, with the basis there times w.
    directions: Vec<([f32; 3], [f32; N])>,
    /// The receivers' view on each sphere, with the cosine of its angular radius; above 1 in a lane that doesn't see it.
    seen: Vec<(Seen, f32x8)>,
    parts: Vec<f32x8>,
}

impl<const N: usize> Traced<N> {
    /// `directions` are unit vectors with the basis there times their solid angle; `spheres` are seen at most.
    pub(crate) fn new(directions: &[(DVec3, Vec<f32>)], spheres: usize) -> Self {
        let directions = (directions.iter())
            .map(|(direction, values)| (direction.as_vec3().to_array(), std::array::from_fn(|i| values[i])))
            .collect();
        Self { directions, seen: Vec::with_capacity(spheres), parts: Vec::with_capacity(spheres) }
    }

    /// Looks at every sphere; returns V.
    #[inline(never)]
    pub(crate) fn visibility(&mut self, blockers: &Blockers<'_>, receivers: &Receivers8) -> ShBatch<N> {
        self.seen.clear();
        let seen = blockers.list.iter().filter_map(|blocker| blockers.hiding(blocker, receivers));
        self.seen.extend(seen.map(|seen| {
            let cosine = (f32x8::ONE - seen.sin_squared).fast_max(f32x8::ZERO).sqrt();
            let limit = seen.sin_squared.simd_gt(f32x8::ZERO).select(cosine, f32x8::splat(2.0));
            (seen, limit)
        }));
        let mut visibility = [f32x8::ZERO; N];
        visibility[0] = f32x8::splat(kernel::FULL);
        for (direction, values) in &self.directions {
            let open = self.seen.iter().fold(f32x8::ONE, |open, seen| holds(seen, direction).select(f32x8::ZERO, open));
            let blocked = f32x8::ONE - open;
            if blocked.simd_gt(f32x8::ZERO).any() {
                visibility.iter_mut().zip(values).for_each(|(v, &y)| *v = blocked.mul_neg_add(f32x8::splat(y), *v));
            }
        }
        visibility
    }

    /// Ṽ of every sphere that [`Self::visibility`] has looked at, in its order; `key` says which is nearer.
    #[inline(never)]
    pub(crate) fn parts(&mut self, key: impl Fn(usize) -> f32x8, brdf: &ShBatch<N>) -> &[f32x8] {
        self.parts.clear();
        self.parts.resize(self.seen.len(), f32x8::ZERO);
        for (direction, values) in &self.directions {
            let (mut nearest, mut first) = (f32x8::splat(f32::INFINITY), f32x8::splat(-1.0));
            for (place, seen) in self.seen.iter().enumerate() {
                let key = key(place);
                let nearer = holds(seen, direction) & key.simd_lt(nearest);
                nearest = nearer.select(key, nearest);
                first = nearer.select(f32x8::splat(place as f32), first);
            }
            if first.simd_lt(f32x8::ZERO).all() {
                continue;
            }
            let cosine = dot_shared(brdf, values);
            for (place, part) in self.parts.iter_mut().enumerate() {
                *part += first.simd_eq(f32x8::splat(place as f32)).select(cosine, f32x8::ZERO);
            }
        }
        &self.parts
    }
}

/// Where a sphere is seen along a direction.
#[inline(always)]
fn holds((seen, limit): &(Seen, f32x8), direction: &[f32; 3]) -> f32x8 {
    let cosine = dot(&direction.map(f32x8::splat), &seen.direction);
    cosine.simd_ge(*limit)
}
