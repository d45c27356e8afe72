//! The spheres that block, and what eight receivers at once see of each ([Guerrero2007, 4.2]).

use halfshade_scene::spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT};
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

/// What eight receivers see of one sphere after the rules of [`halfshade_scene::spheres::adjust`], of which this is the
/// branch-free single-precision twin.
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
    ///
    /// Error of the direction and of sin²θ: some 1e-6 where the plane cuts the sphere well, growing as it becomes
    /// tangent, where the rules' square roots magnify rounding (but what remains of the sphere is small there).
    #[inline(always)]
    pub(super) fn seen_from(&self, position: &[f32x8; 3], normal: &[f32x8; 3], rule: AdjustRule) -> Option<Seen> {
        let dot = |a: &[f32x8; 3], b: &[f32x8; 3]| a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]));
        let radius = f32x8::splat(self.radius);
        let offset: [f32x8; 3] = std::array::from_fn(|axis| f32x8::splat(self.center[axis]) - position[axis]);
        let height = dot(&offset, normal);
        let (moved, reach) = if height.simd_lt(radius).any() {
            let front = ((radius + height) * f32x8::splat(0.5)).fast_max(f32x8::ZERO).fast_min(radius);
            if !front.simd_gt(f32x8::ZERO).any() {
                return None;
            }
            let foot: [f32x8; 3] = std::array::from_fn(|axis| height.mul_neg_add(normal[axis], offset[axis]));
            // Relative floor: where the plane does not cut, the quotient only has to be defined.
            let floor = f32x8::splat((self.radius * self.radius * 1e-12).max(f32::MIN_POSITIVE));
            let cut_squared = ((radius - height) * (radius + height)).fast_max(floor);
            let relative = (dot(&foot, &foot) / cut_squared).sqrt();
            let in_front = match rule {
                AdjustRule::Continuous => height * f32x8::splat(1.0 / (FADE_HEIGHT as f32 * self.radius)),
                AdjustRule::Covering => height * f32x8::splat(1.0 / (COVER_HEIGHT as f32 * self.radius)),
                AdjustRule::Published => height.simd_ge(f32x8::ZERO).select(f32x8::ONE, f32x8::ZERO),
            };
            let scale = (relative - f32x8::ONE).fast_max(in_front).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            let lift = height.fast_max(front) - height;
            let lifted: [f32x8; 3] = std::array::from_fn(|axis| lift.mul_add(normal[axis], offset[axis]));
            let moved = if rule == AdjustRule::Covering {
                let weight = in_front.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
                let pull = weight * (f32x8::ONE - relative.fast_min(f32x8::ONE));
                std::array::from_fn(|axis| pull.mul_neg_add(foot[axis], lifted[axis]))
            } else {
                lifted
            };
            (moved, scale * front)
        } else {
            // Nobody's plane cuts it: what the rules above come to then, bit by bit.
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
    use glam::DVec3;
    use halfshade_scene::spheres::adjust;

    #[test]
    fn matches_the_double_precision_rules() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f32 / (1u64 << 24) as f32 * 2.0 - 1.0
        };
        let (mut seen_count, mut hidden) = (0, 0);
        for _ in 0..4_000 {
            let radius = 0.05 + random().abs();
            let center = [random() * 2.0, random() * 2.0, random() * 2.0];
            let positions: [[f32; 8]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| random()));
            let normals: [DVec3; 8] = std::array::from_fn(|_| {
                DVec3::new(f64::from(random()), f64::from(random()), f64::from(random())).normalize()
            });
            let normal: [f32x8; 3] =
                std::array::from_fn(|axis| f32x8::from(std::array::from_fn::<f32, 8, _>(|i| normals[i][axis] as f32)));
            let blocker = Blocker { center, radius, factors: UNSCALED, emitter: 0, reflection_factor: 1.0 };
            for rule in [AdjustRule::Continuous, AdjustRule::Covering, AdjustRule::Published] {
                let seen = blocker.seen_from(&positions.map(f32x8::from), &normal, rule);
                for (lane, lane_normal) in normals.iter().enumerate() {
                    let offset = DVec3::from_array(std::array::from_fn(|k| f64::from(center[k] - positions[k][lane])));
                    let exact_normal = lane_normal.as_vec3().as_dvec3().normalize();
                    let sin_squared = seen.as_ref().map_or(0.0, |seen| f64::from(seen.sin_squared.to_array()[lane]));
                    match adjust(rule, offset, f64::from(radius), exact_normal) {
                        Some(exact) => {
                            seen_count += 1;
                            let expected = exact.sin_angular_radius().powi(2);
                            assert!((sin_squared - expected).abs() < 2e-5, "{sin_squared} {expected}");
                            let seen = seen.as_ref().expect("something is seen");
                            let direction = DVec3::from_array(seen.direction.map(|c| f64::from(c.to_array()[lane])));
                            assert!(direction.distance(exact.direction()) < 1e-4 || expected < 1e-6);
                        }
                        None => {
                            hidden += 1;
                            assert!(sin_squared < 1e-9);
                        }
                    }
                }
            }
        }
        assert!(seen_count > 10_000 && hidden > 5_000);
    }

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
