//! The spheres that block, and the view of eight receivers at once on each ([Guerrero2007, 4.2]).

use crate::shared::{tangent_plane::OverPlane, vector::dot};
use halfshade_scene::spheres::AdjustRule;
use halfshade_sh::{blocker_table::BlockerTable, kernel::MAX_BANDS};
use wide::f32x8;

/// Factors that change nothing.
pub(crate) const UNSCALED: [f32; MAX_BANDS] = [1.0; MAX_BANDS];

/// One sphere in light space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blocker {
    /// Centre.
    pub center: [f32; 3],
    /// Radius.
    pub radius: f32,
    /// How much of each band of its logarithm counts: shares of overlapping spheres, ratios of parents to children.
    pub factors: [f32; MAX_BANDS],
    /// Its number among the spheres of all levels.
    pub emitter: u32,
    /// Factor of its reflected light: the ratio of a parent to its children.
    pub reflection_factor: f32,
}

/// The spheres that receivers see, and how they are looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blockers<'a> {
    pub(crate) list: &'a [Blocker],
    /// Zonal vectors of blockers by angular radius: logarithms, or blockers less one.
    pub(crate) table: &'a BlockerTable,
    /// Treatment of spheres that cut a receiver's tangent plane.
    pub(crate) rule: AdjustRule,
    /// The spheres of the receivers' own object.
    pub(crate) own: OwnSpheres,
}

/// The spheres of an object, by their numbers among those of all levels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OwnSpheres {
    /// The first of them.
    pub first: u32,
    /// How many they are.
    pub count: u32,
}

/// Eight receivers in light space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receivers8 {
    pub(crate) position: [f32x8; 3],
    /// Unit.
    pub(crate) normal: [f32x8; 3],
    /// The lanes that know otherwise what their own object hides, and don't ask its spheres.
    pub(crate) knows_own: f32x8,
}

/// The view of eight receivers on one sphere after the rules of [`halfshade_scene::spheres::adjust`].
pub(crate) struct Seen {
    /// Unit direction to the adjusted sphere's centre.
    pub(crate) direction: [f32x8; 3],
    /// Squared sine of its angular radius; exactly 0 where the sphere has no influence.
    pub(crate) sin_squared: f32x8,
}

/// 1 less the cosine of angular radii, from their squared sines in [0, 1]: without cancellation.
#[inline(always)]
pub(crate) fn versine(sin_squared: f32x8) -> f32x8 {
    sin_squared / (f32x8::ONE + (f32x8::ONE - sin_squared).sqrt())
}

impl OwnSpheres {
    #[inline(always)]
    pub(crate) fn contains(self, sphere: u32) -> bool {
        sphere.wrapping_sub(self.first) < self.count
    }
}

impl Blockers<'_> {
    /// The view of `receivers` on a sphere of the list that hides the environment from them, as [`Blocker::seen_from`].
    #[inline(always)]
    pub(crate) fn hiding(&self, blocker: &Blocker, receivers: &Receivers8) -> Option<Seen> {
        if !self.own.contains(blocker.emitter) {
            return blocker.seen_from(receivers, self.rule);
        }
        if receivers.knows_own.all() {
            return None;
        }
        let seen = blocker.seen_from(receivers, self.rule)?;
        Some(Seen { sin_squared: receivers.knows_own.select(f32x8::ZERO, seen.sin_squared), ..seen })
    }
}

impl Blocker {
    /// `zonal` times this sphere's factors.
    #[inline(always)]
    pub(crate) fn times_factors(&self, zonal: [f32x8; MAX_BANDS]) -> [f32x8; MAX_BANDS] {
        if self.factors == UNSCALED {
            // Most spheres are: eight comparisons at once are cheaper than the products.
            return zonal;
        }
        let mut scaled = zonal;
        scaled.iter_mut().zip(self.factors).for_each(|(value, factor)| *value *= f32x8::splat(factor));
        scaled
    }

    /// The view of `receivers`; `None` if none of the eight sees anything, in which case every lane's `sin_squared` would
    /// be 0.
    #[inline(always)]
    pub(crate) fn seen_from(&self, receivers: &Receivers8, rule: AdjustRule) -> Option<Seen> {
        let Receivers8 { position, normal, .. } = receivers;
        let radius = f32x8::splat(self.radius);
        let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(self.center[axis]) - position[axis]);
        let over = OverPlane::new(offset, radius, *normal);
        let (moved, reach) = if over.is_cut().any() {
            over.adjusted(rule, over.height * f32x8::splat(1.0 / self.radius))?
        } else {
            (offset, radius)
        };
        let per_distance_squared = f32x8::ONE / dot(&moved, &moved).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let sin_squared = (reach * reach * per_distance_squared).fast_min(f32x8::ONE);
        let per_distance = per_distance_squared.sqrt();
        Some(Seen { direction: moved.map(|axis| axis * per_distance), sin_squared })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defined_at_the_centre_on_the_surface_and_next_to_it() {
        for radius in [1e-3f32, 1.0, 1e3] {
            let blocker = Blocker { center: [0.0; 3], radius, factors: UNSCALED, emitter: 0, reflection_factor: 1.0 };
            for distance in [0.0, 1e-7, 1.0 - 1e-7, 1.0, 1.0 + 1e-7] {
                for sign in [-1.0, 1.0] {
                    let position = [f32x8::ZERO, f32x8::splat(radius * distance * sign), f32x8::ZERO];
                    let normal = [f32x8::ZERO, f32x8::ONE, f32x8::ZERO];
                    for rule in [AdjustRule::Continuous, AdjustRule::Covering, AdjustRule::Published] {
                        let receivers = Receivers8 { position, normal, knows_own: f32x8::ZERO };
                        if let Some(seen) = blocker.seen_from(&receivers, rule) {
                            assert!(seen.direction.iter().all(|c| c.to_array()[0].is_finite()));
                            assert!((0.0..=1.0).contains(&seen.sin_squared.to_array()[0]));
                        }
                    }
                }
            }
        }
    }
}
