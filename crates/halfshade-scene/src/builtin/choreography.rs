//! The time line that built-in scenes share, and movements written down as functions of time.

use crate::{Motion, Pose};
use glam::{Quat, Vec3};
use std::f64::consts::TAU;

/// Frames per second of every built-in scene.
pub(super) const FRAMES_PER_SEC: f64 = 30.0;
/// Length of every built-in scene in frames.
pub(super) const FRAME_COUNT: usize = 120;
/// Length of every built-in scene in seconds; movements that come back do so after this time.
pub(super) const DURATION_SECS: f64 = FRAME_COUNT as f64 / FRAMES_PER_SEC;

/// One key every third frame: between them, straight lines are within a thousandth of the movements used here.
const KEY_COUNT: usize = FRAME_COUNT / 3;

/// Keyframes of a movement given as a function of seconds.
pub(super) fn keyframes(pose_at: impl Fn(f64) -> Pose) -> Motion {
    let key = |i: usize| {
        let time_secs = DURATION_SECS * i as f64 / KEY_COUNT as f64;
        (time_secs, pose_at(time_secs))
    };
    Motion::Keyframes((0..=KEY_COUNT).map(key).collect())
}

/// `sin` of `cycles` full turns over the time line, shifted by `phase` turns.
pub(super) fn wave(time_secs: f64, cycles: f64, phase: f64) -> f32 {
    (TAU * (cycles * time_secs / DURATION_SECS + phase)).sin() as f32
}

/// A pose standing upright at `place`, turned by `yaw` radians around +Y.
pub(super) fn upright(place: Vec3, yaw: f32, scale: f32) -> Pose {
    Pose { scale, rotation: Quat::from_rotation_y(yaw), translation: place }
}
