//! The box that scenes stand on.

use super::shapes;
use crate::{Material, Motion, Object, Pose};
use glam::Vec3;
use std::sync::Arc;

/// A still box that receives only, its top at y = 0 and divided for receivers.
pub(super) fn ground(half_size: Vec3, divisions: [usize; 2], albedo: Vec3, cluster_count: usize) -> Object {
    Object {
        name: "ground".into(),
        mesh: Arc::new(shapes::slab(half_size, divisions)),
        material: Material::new(albedo),
        sphere_count: 0,
        spheres: None,
        cluster_count,
        motion: Motion::Still(Pose::from_translation(Vec3::new(0.0, -half_size.y, 0.0))),
        skin: None,
    }
}
