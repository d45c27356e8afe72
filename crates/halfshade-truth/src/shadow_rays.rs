//! The rays of an estimate, laid open.

use crate::{
    Options, REPLICATES, Tracer, batch::Batch, estimate::for_every_batch, options::MAX_SAMPLES, points::Points,
};
use glam::{DVec3, Vec3};
use halfshade_scene::Receivers;

/// A ray towards light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRay {
    /// Origin in world space.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Distance of the light, in metres; infinite for distant light.
    pub distance: f32,
}

/// The rays that [`crate::estimate`] traces for a fixed number of samples, in the same order: to inspect them, and to
/// compare its speed with that of other tracers. Rays that lobes draw are left out.
pub fn shadow_rays(tracer: &Tracer, receivers: Receivers<'_>, options: &Options) -> Vec<ShadowRay> {
    let points = Points::first(options.samples.clamp(1, MAX_SAMPLES).div_ceil(REPLICATES));
    let (mut batch, mut rays) = (Batch::new(), Vec::new());
    for i in 0..receivers.len() {
        let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
        if !(position.is_finite() && normal.is_finite()) {
            continue;
        }
        let receiver = tracer.receiver(position, normal);
        let origin = tracer.space.point_in_world(receiver.ray_origin);
        for (number, integral) in tracer.lights.integrals().enumerate() {
            let seed = (options.seed, receivers.index[i]);
            for_every_batch(tracer, (number as u32, integral), &receiver, seed, &points, &mut batch, |_, batch| {
                rays.extend((0..batch.len).filter(|&k| batch.carries_light(k)).map(|k| ShadowRay {
                    origin,
                    direction: Vec3::from_array(batch.direction.each_ref().map(|axis| axis[k])),
                    distance: tracer.space.length_in_world(f64::from(batch.distance[k])) as f32,
                }));
            });
        }
    }
    rays
}
