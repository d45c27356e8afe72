//! One receiver on its own.

use crate::shadow_field::{prepare::frame::FrameData, shade::traced::LightSpaceReceiver};
use halfshade_scene::{Receivers, SurfacePoint};
use wide::f32x8;

/// A receiver in light space.
pub(crate) struct Receiver {
    pub(crate) place: LightSpaceReceiver,
    /// Its position in every lane.
    pub(crate) position: [f32x8; 3],
    pub(crate) surface: SurfacePoint,
    pub(crate) is_glossy: bool,
}

impl Receiver {
    pub(crate) fn new(frame: &FrameData, receivers: &Receivers<'_>, i: usize, object: usize, is_glossy: bool) -> Self {
        let position = frame.point(receivers.position_at(i).as_dvec3());
        let normal = frame.direction(receivers.normal_at(i));
        Self {
            place: LightSpaceReceiver { object, position, normal },
            position: position.map(f32x8::splat),
            surface: receivers.surface[i],
            is_glossy,
        }
    }
}
