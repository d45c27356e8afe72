//! The spheres that block, and what eight receivers at once see of each ([Guerrero2007, 4.2]).

use crate::shared::{tangent_plane::OverPlane, vector::dot};
use halfshade_scene::spheres::AdjustRule;
use halfshade_sh::kernel::MAX_BANDS;
use wide::f32x8;

/// Factors that change nothing.
pub(super) const UNSCALED: [f32; MAX_BANDS] = [1.0; MAX_BANDS];

/// One sphere in light space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Blocker {
    pub(super) center: [f32; 3],
    pub(super) radius: f32,
    /// How much of each band of its logarithm counts: shares of overlapping spheres, ratios of parents to children.
    pub(super) factors: [f32; MAX_BANDS],
    /// Its number among the spheres of all levels.
    pub(super) emitter: u32,
    /// What its reflected light is multiplied with: the ratio of a parent to its children.
    pub(super) reflection_factor: f32,
}

/// What eight receivers see of one sphere after the rules of [`halfshade_scene::spheres::adjust`].
pub(super) struct Seen {
    /// Unit direction to the adjusted sphere's centre.
    pub(super) direction: [f32x8; 3],
    /// Squared sine of its angular radius; exactly 0 where the sphere has no influence.
    pub(super) sin_squared: f32x8,
}

impl Blocker {
    /// `zonal` times this sphere's factors.
    #[inline(always)]
    pub(super) fn times_factors(&self, zonal: [f32x8; MAX_BANDS]) -> [f32x8; MAX_BANDS] {
        if self.factors == UNSCALED {
            // Most spheres are: eight comparisons at once are cheaper than the products.
            return zonal;
        }
        let mut scaled = zonal;
        scaled.iter_mut().zip(self.factors).for_each(|(value, factor)| *value *= f32x8::splat(factor));
        scaled
    }

    /// What receivers at `position` with unit `normal` see, or `None` if none of the eight sees anything, in which case
    /// every lane's `sin_squared` would be 0.
    #[inline(always)]
    pub(super) fn seen_from(&self, position: &[f32x8; 3], normal: &[f32x8; 3], rule: AdjustRule) -> Option<Seen> {
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
                        if let Some(seen) = blocker.seen_from(&position, &normal, rule) {
                            assert!(seen.direction.iter().all(|c| c.to_array()[0].is_finite()));
                            assert!((0.0..=1.0).contains(&seen.sin_squared.to_array()[0]));
                        }
                    }
                }
            }
        }
    }
}
