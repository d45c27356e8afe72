//! One moment of a scene: the poses and the light that strategies see in `prepare`.

use crate::{Pose, Scene, SphereLight};
use glam::{Quat, Vec3};

/// One moment of a scene. Fields are public so that tests can build moments no time line holds.
#[derive(Debug, Clone)]
pub struct Frame<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Frame number.
    pub index: usize,
    /// Pose of each object, in the order of `scene.objects`.
    pub world_from_object: Vec<Pose>,
    /// Rotation of the environment.
    pub world_from_environment: Quat,
    /// The local lights, moved.
    pub lights: Vec<SphereLight>,
}

impl Frame<'_> {
    /// Radiance that arrives from infinitely far along unit `direction_in_world` (pointing away from the receiver).
    pub fn environment_radiance(&self, direction_in_world: Vec3) -> Vec3 {
        self.scene.environment.radiance(self.world_from_environment.conjugate() * direction_in_world)
    }
}
