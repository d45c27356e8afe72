//! Eight receivers of one object side by side.

use crate::shadow_field::{prepare::frame::FrameData, shade::traced::LightSpaceReceiver};
use glam::Vec3;
use halfshade_scene::Receivers;
use halfshade_sh::kernel::LANES;
use std::ops::Range;
use wide::f32x8;

/// Receivers in light space; the last one fills up what is left of eight.
pub(crate) struct Batch<'a> {
    pub(crate) receivers: Receivers<'a>,
    pub(crate) object: usize,
    start: usize,
    lanes: usize,
    positions: [[f32; 3]; LANES],
    normals: [Vec3; LANES],
    /// The same, axis by axis.
    pub(crate) position: [f32x8; 3],
    pub(crate) normal: [f32x8; 3],
}

impl<'a> Batch<'a> {
    /// The first receivers of a range.
    pub(crate) fn new(frame: &FrameData, receivers: Receivers<'a>, object: usize, range: Range<usize>) -> Self {
        let (start, lanes) = (range.start, range.len().min(LANES));
        let lane = |k: usize| start + k.min(lanes - 1);
        let positions: [[f32; 3]; LANES] =
            std::array::from_fn(|k| frame.point(receivers.position_at(lane(k)).as_dvec3()));
        let normals: [Vec3; LANES] = std::array::from_fn(|k| frame.direction(receivers.normal_at(lane(k))));
        Self {
            receivers,
            object,
            start,
            lanes,
            positions,
            normals,
            position: std::array::from_fn(|axis| f32x8::from(positions.map(|p| p[axis]))),
            normal: std::array::from_fn(|axis| f32x8::from(normals.map(|n| n[axis]))),
        }
    }

    /// Number of the receiver in a lane.
    pub(crate) fn number(&self, lane: usize) -> usize {
        self.start + lane.min(self.lanes - 1)
    }

    /// The lanes that have a receiver of their own.
    pub(crate) fn lanes(&self) -> Range<usize> {
        0..self.lanes
    }

    /// The receiver in a lane.
    pub(crate) fn receiver(&self, lane: usize) -> LightSpaceReceiver {
        LightSpaceReceiver { object: self.object, position: self.positions[lane], normal: self.normals[lane] }
    }
}
