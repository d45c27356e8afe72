//! Spheres that cut the tangent plane of who sees them, eight at a time: the branch-free single-precision twin of
//! [`halfshade_scene::spheres::adjust`].

use super::vector::dot;
use halfshade_scene::spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT};
use wide::f32x8;

/// Eight pairs of a sphere and a receiver, lane by lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OverPlane {
    offset: [f32x8; 3],
    radius: f32x8,
    normal: [f32x8; 3],
    /// Height of the centre over the plane.
    pub(crate) height: f32x8,
}

impl OverPlane {
    /// Pairs of spheres whose centres are at `offset` from receivers with unit `normal`.
    #[inline(always)]
    pub(crate) fn new(offset: [f32x8; 3], radius: f32x8, normal: [f32x8; 3]) -> Self {
        Self { offset, radius, normal, height: dot(&offset, &normal) }
    }

    /// Where the sphere reaches the plane: a mask. All others stay as they are under every rule.
    #[inline(always)]
    pub(crate) fn is_cut(&self) -> f32x8 {
        self.height.simd_lt(self.radius)
    }

    /// Offsets and radii after the rules; a radius of 0 has no influence. `None` if none of the eight has.
    /// `relative_height` is the height over the radius.
    ///
    /// Error of the direction and of sin²θ: some 1e-6 where the plane cuts the sphere well, growing as it becomes
    /// tangent, where the rules' square roots magnify rounding (but what remains of the sphere is small there).
    #[inline(always)]
    pub(crate) fn adjusted(&self, rule: AdjustRule, relative_height: f32x8) -> Option<([f32x8; 3], f32x8)> {
        let Self { offset, radius, normal, height } = *self;
        let front = ((radius + height) * f32x8::splat(0.5)).fast_max(f32x8::ZERO).fast_min(radius);
        if !front.simd_gt(f32x8::ZERO).any() {
            return None;
        }
        let foot: [f32x8; 3] = std::array::from_fn(|axis| height.mul_neg_add(normal[axis], offset[axis]));
        // Relative floor: where the plane does not cut, the quotient only has to be defined.
        let floor = (radius * radius * f32x8::splat(1e-12)).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let cut_squared = ((radius - height) * (radius + height)).fast_max(floor);
        let relative = (dot(&foot, &foot) / cut_squared).sqrt();
        let in_front = match rule {
            AdjustRule::Continuous => relative_height * f32x8::splat((1.0 / FADE_HEIGHT) as f32),
            AdjustRule::Covering => relative_height * f32x8::splat((1.0 / COVER_HEIGHT) as f32),
            AdjustRule::Published => height.simd_ge(f32x8::ZERO).select(f32x8::ONE, f32x8::ZERO),
        };
        let in_front = in_front.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        let scale = (relative - f32x8::ONE).fast_max(in_front).fast_min(f32x8::ONE);
        let lift = height.fast_max(front) - height;
        let lifted: [f32x8; 3] = std::array::from_fn(|axis| lift.mul_add(normal[axis], offset[axis]));
        let moved = if rule == AdjustRule::Covering {
            // Not where the foot is as good as the receiver's place, but the plane does not cut.
            let pull = self.is_cut().select(in_front * (f32x8::ONE - relative.fast_min(f32x8::ONE)), f32x8::ZERO);
            std::array::from_fn(|axis| pull.mul_neg_add(foot[axis], lifted[axis]))
        } else {
            lifted
        };
        Some((moved, scale * front))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;
    use glam::DVec3;
    use halfshade_scene::spheres::adjust;

    const RULES: [AdjustRule; 3] = [AdjustRule::Continuous, AdjustRule::Covering, AdjustRule::Published];

    #[test]
    fn matches_the_double_precision_rules() {
        let mut random = random(7);
        let (mut seen, mut hidden) = (0, 0);
        for _ in 0..4_000 {
            let offsets: [[f32; 8]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * random()));
            let radii: [f32; 8] = std::array::from_fn(|_| 0.05 + random().abs());
            let normals: [DVec3; 8] = std::array::from_fn(|_| {
                DVec3::from_array(std::array::from_fn(|_| f64::from(random()))).normalize_or(DVec3::Y)
            });
            let lanes = |axis: usize| f32x8::from(normals.map(|normal| normal.to_array()[axis] as f32));
            let radius = f32x8::from(radii);
            let over = OverPlane::new(offsets.map(f32x8::from), radius, std::array::from_fn(lanes));
            for rule in RULES {
                let (moved, reach) =
                    over.adjusted(rule, over.height / radius).unwrap_or(([f32x8::ONE; 3], f32x8::ZERO));
                for lane in 0..8 {
                    let offset = DVec3::from_array(offsets.map(|axis| f64::from(axis[lane])));
                    let normal = normals[lane].as_vec3().as_dvec3().normalize();
                    let found = DVec3::from_array(moved.map(|axis| f64::from(axis.to_array()[lane])));
                    let sine_squared = (f64::from(reach.to_array()[lane]) / found.length()).min(1.0).powi(2);
                    if let Some(exact) = adjust(rule, offset, f64::from(radii[lane]), normal) {
                        seen += 1;
                        let expected = exact.sin_angular_radius().powi(2);
                        assert!((sine_squared - expected).abs() < 2e-5, "{sine_squared} {expected}");
                        assert!(found.normalize().distance(exact.direction()) < 1e-4 || expected < 1e-6);
                    } else {
                        hidden += 1;
                        assert!(sine_squared < 1e-9);
                    }
                }
            }
        }
        assert!(seen > 10_000 && hidden > 5_000, "{seen} {hidden}");
    }

    /// So that nobody's neighbours change what he sees.
    #[test]
    fn spheres_that_the_plane_does_not_cut_stay_as_they_are() {
        let mut random = random(8);
        for step in 0..1_000 {
            let normal = DVec3::from_array(std::array::from_fn(|_| f64::from(random()))).normalize_or(DVec3::Y);
            let normal = normal.as_vec3().to_array();
            // From far aside to next to straight above.
            let aside = 0.1f32.powi(step % 10);
            let offset: [f32; 3] = std::array::from_fn(|axis| 2.0 * normal[axis] + aside * random());
            let height: f32 = (0..3).map(|axis| offset[axis] * normal[axis]).sum();
            let radius = f32x8::splat(0.999 * height);
            let over = OverPlane::new(offset.map(f32x8::splat), radius, normal.map(f32x8::splat));
            assert!(over.is_cut().none());
            for rule in RULES {
                let (moved, reach) = over.adjusted(rule, over.height / radius).unwrap();
                assert_eq!((moved.map(|axis| axis.to_array()[0]), reach), (offset, radius));
            }
        }
    }
}
