//! Pose of an object: a similarity transform.

use glam::{Quat, Vec3};
use serde::Serialize;

/// A similarity: uniform scale, then rotation, then translation.
///
/// `point_in_world = rotation · (scale · point_in_object) + translation`. Non-uniform scale is left out on purpose:
/// spheres would not stay spheres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pose {
    /// Uniform scale, positive.
    pub scale: f32,
    /// Rotation, unit length.
    pub rotation: Quat,
    /// Translation in metres.
    pub translation: Vec3,
}

impl Pose {
    /// The pose that changes nothing.
    pub const IDENTITY: Self = Self { scale: 1.0, rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// Moves only.
    pub const fn from_translation(translation: Vec3) -> Self {
        Self { translation, ..Self::IDENTITY }
    }

    /// A point of the object, in the outer space.
    pub fn transform_point(&self, point: Vec3) -> Vec3 {
        self.rotation * (self.scale * point) + self.translation
    }

    /// A unit direction or normal of the object, in the outer space. Length is kept: the scale is uniform.
    pub fn transform_direction(&self, direction: Vec3) -> Vec3 {
        self.rotation * direction
    }

    /// First `self`, then `outer`.
    pub fn then(&self, outer: &Self) -> Self {
        Self {
            scale: self.scale * outer.scale,
            rotation: (outer.rotation * self.rotation).normalize(),
            translation: outer.transform_point(self.translation),
        }
    }

    /// The pose that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        let scale = self.scale.recip();
        Self { scale, rotation, translation: rotation * (-scale * self.translation) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_and_then_cancel() {
        let pose = Pose {
            scale: 2.5,
            rotation: Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7),
            translation: Vec3::new(4.0, -1.0, 0.5),
        };
        let point = Vec3::new(0.3, -0.2, 0.9);
        assert!(pose.then(&pose.inverse()).transform_point(point).distance(point) < 1e-5);
        assert!(pose.inverse().transform_point(pose.transform_point(point)).distance(point) < 1e-5);
    }
}
