//! The scene in a frame.

use super::{
    blockers::{Ball, Spheres},
    environment::Surroundings,
    light::Light,
};
use glam::{DVec3, Vec3};
use halfshade_scene::EyeLobes;

/// What shading reads of a frame. Lengths are about the origin of the frame, so that a scene may lie anywhere.
#[derive(Debug)]
pub(super) struct Moment {
    pub(super) origin: DVec3,
    pub(super) spheres: Spheres,
    /// Around all of them.
    pub(super) ball: Ball,
    pub(super) lights: Vec<Light>,
    pub(super) surroundings: Option<Surroundings>,
    /// All directions alike, for receivers within a light.
    pub(super) everywhere: Option<Surroundings>,
    pub(super) eye_lobes: Option<EyeLobes>,
}

impl Moment {
    /// A point of the world, about the origin.
    pub(super) fn local(&self, point: Vec3) -> [f32; 3] {
        (point.as_dvec3() - self.origin).as_vec3().to_array()
    }
}
