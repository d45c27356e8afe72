//! The sphere reference: what a receiver sees of the scene's spheres, each adjusted to it ([Guerrero2007, 4.2]).

use crate::{
    batch::{BATCH, Batch},
    receiver::Receiver,
    tracer::Tracer,
};
use glam::Vec3;
use halfshade_scene::spheres::{AdjustRule, adjust};

/// One adjusted sphere: the unit direction to its centre, the squared sine of its angular radius, its distance in
/// tracing space.
#[derive(Debug, Clone, Copy)]
struct Cap {
    axis: [f32; 3],
    sine_squared: f32,
    distance: f32,
    /// Its place among the tracer's spheres.
    sphere: u32,
}

/// The adjusted spheres of one receiver; its storage is used again for the next.
#[derive(Debug, Default)]
pub(crate) struct Caps(Vec<Cap>);

impl Caps {
    /// Adjusts all spheres to `receiver`.
    pub(crate) fn adjust(&mut self, tracer: &Tracer, rule: AdjustRule, receiver: &Receiver) {
        self.0.clear();
        self.0.extend(tracer.spheres.iter().enumerate().filter_map(|(number, &(center, radius))| {
            let sphere = adjust(rule, center - receiver.position, radius, receiver.normal)?;
            Some(Cap {
                axis: sphere.direction().as_vec3().to_array(),
                sine_squared: sphere.sin_angular_radius().powi(2) as f32,
                distance: tracer.space.length(sphere.offset.length()) as f32,
                sphere: number as u32,
            })
        }));
    }

    /// Whether no sphere is left.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The first sphere along unit `direction`: its place, the distance in tracing space, and its unit normal there.
    pub(crate) fn first_hit(&self, direction: Vec3) -> Option<(usize, f32, Vec3)> {
        let mut first = None;
        let mut nearest = f32::INFINITY;
        for cap in &self.0 {
            let axis = Vec3::from(cap.axis);
            let rest = cap.sine_squared - axis.cross(direction).length_squared();
            let cosine = axis.dot(direction);
            let begins = cap.distance * (cosine - rest.max(0.0).sqrt());
            if rest > 0.0 && cosine > 0.0 && begins < nearest {
                (nearest, first) = (begins, Some(cap));
            }
        }
        first.map(|cap| {
            let normal = nearest * direction - cap.distance * Vec3::from(cap.axis);
            (cap.sphere as usize, nearest, normal.normalize_or(-direction))
        })
    }

    /// Sets the visibility of every sample: blocked if any cap holds its direction, and its sphere begins before the
    /// ray ends. All samples against one sphere at a time: no branches, whole vector registers.
    pub(crate) fn trace(&self, batch: &mut Batch) {
        let [x, y, z] = &batch.direction;
        let mut visible = [1.0_f32; BATCH];
        for cap in &self.0 {
            let [ax, ay, az] = cap.axis;
            for k in 0..BATCH {
                // The cross product instead of the cosine: 1 - cos loses all digits of a small angle.
                let (cx, cy, cz) = (ay * z[k] - az * y[k], az * x[k] - ax * z[k], ax * y[k] - ay * x[k]);
                let rest = cap.sine_squared - (cx * cx + cy * cy + cz * cz);
                let cosine = ax * x[k] + ay * y[k] + az * z[k];
                let begins = cap.distance * (cosine - rest.max(0.0).sqrt());
                let blocked = (rest > 0.0) & (cosine > 0.0) & (begins < batch.distance[k]);
                visible[k] = if blocked { 0.0 } else { visible[k] };
            }
        }
        batch.visible = visible;
    }
}
