//! Eight spheres as one receiver sees them, after the rules for those that cut its tangent plane.

use crate::shared::tangent_plane::OverPlane;
use halfshade_scene::spheres::AdjustRule;
use wide::f32x8;

/// A point of a surface, about the origin of the frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receiver {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
}

impl Receiver {
    /// Eight spheres as it sees them: offsets of centres and radii, after the rules of [`halfshade_scene::spheres::adjust`].
    /// A radius of 0 has no influence.
    #[inline(always)]
    pub(crate) fn adjusted(&self, center: &[f32x8; 3], radius: f32x8, rule: AdjustRule) -> ([f32x8; 3], f32x8) {
        let offset: [f32x8; 3] = std::array::from_fn(|axis| center[axis] - f32x8::splat(self.position[axis]));
        let over = OverPlane::new(offset, radius, self.normal.map(f32x8::splat));
        if !over.is_cut().any() {
            return (offset, radius);
        }
        // Groups are filled up with spheres of no size.
        let relative_height = over.height / radius.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        over.adjusted(rule, relative_height).unwrap_or((offset, f32x8::ZERO))
    }
}
