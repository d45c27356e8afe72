//! Visibility of a batch of samples, by rays against the mesh.

use crate::{
    batch::Batch,
    receiver::Receiver,
    tracer::{Tracer, tracing_ray},
};
use glam::Vec3A;

/// Sets the visibility of every sample that carries light; returns how many rays that took.
pub(crate) fn trace_mesh(tracer: &Tracer, from: &Receiver, batch: &mut Batch) -> u64 {
    let mut rays = 0;
    for k in 0..batch.len {
        batch.visible[k] = 0.0;
        if batch.carries_light(k) {
            rays += 1;
            let direction = Vec3A::new(batch.direction[0][k], batch.direction[1][k], batch.direction[2][k]);
            let ray = tracing_ray(from.ray_origin, direction, batch.distance[k]);
            batch.visible[k] = f32::from(tracer.unoccluded(ray, from.slack));
        }
    }
    rays
}
