//! The box that scenes stand on.

use super::shapes;
use crate::{Object, Pose};
use glam::Vec3;

/// A still box that receives only, its top at y = 0 and divided for receivers.
pub(super) fn ground(half_size: Vec3, divisions: [usize; 2], albedo: Vec3, cluster_count: usize) -> Object {
    Object::new("ground", shapes::slab(half_size, divisions))
        .albedo(albedo)
        .cluster_count(cluster_count)
        .pose(Pose::from_translation(Vec3::new(0.0, -half_size.y, 0.0)))
}
