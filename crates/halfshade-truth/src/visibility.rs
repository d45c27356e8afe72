//! Visibility of a batch of samples, by rays against the mesh.

use crate::{batch::Batch, receiver::Receiver, tracer::Tracer};
use glam::Vec3;

/// Sets the visibility of every sample that carries light; returns how many rays that took.
pub(crate) fn trace_mesh(tracer: &Tracer, from: &Receiver, batch: &mut Batch) -> u64 {
    let mut rays = 0;
    for k in 0..batch.len {
        batch.visible[k] = 0.0;
        if batch.carries_light(k) {
            rays += 1;
            let direction = Vec3::from_array(batch.direction.each_ref().map(|axis| axis[k]));
            batch.visible[k] = f32::from(!tracer.is_blocked_from(from, direction, batch.distance[k]));
        }
    }
    rays
}
