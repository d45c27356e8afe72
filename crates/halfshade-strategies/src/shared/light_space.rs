//! The space of the light: turned like the environment, so that its tables hold for every turn, about an origin of the frame's.

use super::origin::origin_of;
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::{Frame, Pose};

/// Light space, from the world.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LightSpace {
    /// A point of the world is `rotation · (point - origin)` here.
    pub(crate) rotation: DMat3,
    pub(crate) origin: DVec3,
}

impl LightSpace {
    /// The space of a frame's light, about the middle of `points` of the world.
    pub(crate) fn new(frame: &Frame<'_>, points: impl IntoIterator<Item = DVec3>) -> Self {
        let rotation = DMat3::from_quat(frame.world_from_environment.as_dquat().normalize().conjugate());
        Self { rotation, origin: origin_of(points) }
    }

    /// A point of the world.
    pub(crate) fn place(&self, point: DVec3) -> DVec3 {
        self.rotation * (point - self.origin)
    }

    /// The same in single precision.
    pub(crate) fn point(&self, point: DVec3) -> Vec3 {
        self.place(point).as_vec3()
    }

    /// A direction of the world.
    pub(crate) fn direction(&self, direction: Vec3) -> Vec3 {
        (self.rotation * direction.as_dvec3()).as_vec3()
    }

    /// Rotation from here into the space of an object.
    pub(crate) fn object_from_light(&self, pose: &Pose) -> DMat3 {
        DMat3::from_quat(pose.rotation.as_dquat().normalize().conjugate()) * self.rotation.transpose()
    }

    /// Its rows in single precision.
    pub(crate) fn rows_into_object(&self, pose: &Pose) -> [[f32; 3]; 3] {
        let rows = self.object_from_light(pose).transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3().to_array())
    }
}
