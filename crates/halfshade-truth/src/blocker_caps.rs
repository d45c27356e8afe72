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
struct BlockerCap {
    axis: [f32; 3],
    sine_squared: f32,
    distance: f32,
    /// Index among the tracer's spheres.
    sphere: u32,
}

/// The adjusted spheres of one receiver; its storage is used again for the next.
#[derive(Debug, Default)]
pub(crate) struct BlockerCaps(Vec<BlockerCap>);

impl BlockerCaps {
    /// Adjusts all spheres to `receiver`.
    pub(crate) fn adjust(&mut self, tracer: &Tracer, rule: AdjustRule, receiver: &Receiver) {
        self.0.clear();
        self.0.extend(tracer.spheres.iter().enumerate().filter_map(|(number, &(center, radius))| {
            let sphere = adjust(rule, center - receiver.position, radius, receiver.normal)?;
            Some(BlockerCap {
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

    /// Sets the visibility of every sample in use: blocked if any cap holds its direction, and its sphere begins before
    /// the ray ends. All samples against one sphere at a time: no branches, whole vector registers.
    pub(crate) fn trace(&self, batch: &mut Batch) {
        let whole = batch.len.next_multiple_of(LANES).min(BATCH);
        let [x, y, z] = batch.direction.each_ref().map(|axis| &axis[..whole]);
        let ends = &batch.distance[..whole];
        let visible = &mut batch.visible[..whole];
        visible.fill(1.0);
        let cone = Cone::around(batch.direction.each_ref().map(|axis| &axis[..batch.len]));
        for cap in self.0.iter().filter(|cap| cone.meets(cap)) {
            let [ax, ay, az] = cap.axis;
            for k in 0..whole {
                // The cross product instead of the cosine: 1 - cos loses all digits of a small angle.
                let (cx, cy, cz) = (ay * z[k] - az * y[k], az * x[k] - ax * z[k], ax * y[k] - ay * x[k]);
                let rest = cap.sine_squared - (cx * cx + cy * cy + cz * cz);
                let cosine = ax * x[k] + ay * y[k] + az * z[k];
                let begins = cap.distance * (cosine - rest.max(0.0).sqrt());
                let blocked = (rest > 0.0) & (cosine > 0.0) & (begins < ends[k]);
                visible[k] = if blocked { 0.0 } else { visible[k] };
            }
        }
    }
}

/// Samples that a vector register may hold; batches are traced in whole ones.
const LANES: usize = 16;

/// A cone around directions: rays toward a small light meet few of many spheres, and the others needn't be tried.
struct Cone {
    axis: Vec3,
    cosine: f32,
}

impl Cone {
    fn around([x, y, z]: [&[f32]; 3]) -> Self {
        let directions = || x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z));
        let axis = directions().sum::<Vec3>().normalize_or(Vec3::Y);
        let cosine = directions().map(|direction| axis.dot(direction)).fold(1.0, f32::min);
        // Wider by more than what rounding takes.
        Self { axis, cosine: cosine - 1e-5 }
    }

    /// Whether any direction of the cone may lie in the cap; true if in doubt.
    fn meets(&self, cap: &BlockerCap) -> bool {
        let cap_cosine = (1.0 - cap.sine_squared).max(0.0).sqrt();
        let sines = (cap.sine_squared * (1.0 - self.cosine * self.cosine).max(0.0)).sqrt();
        // Cosine of the sum of both angles, where that is less than a straight one; in front of the cap, wider never
        // misses.
        self.cosine <= -cap_cosine || self.axis.dot(cap.axis.into()) >= self.cosine * cap_cosine - sines - 1e-5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// One by one, against every cap.
    #[test]
    fn a_cap_left_out_holds_no_sample() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut unit =
            move || Vec3::from(std::array::from_fn::<f32, 3, _>(|_| random.random_range(-1.0..1.0))).normalize();
        let (mut blocked, mut left_out) = (0, 0);
        for case in 0..2_000_u32 {
            let width = [0.001, 0.05, 0.4, 3.0][case as usize % 4];
            let axis = unit();
            let mut batch = Batch::new();
            batch.len = 1 + case as usize % BATCH;
            for k in 0..batch.len {
                batch.set_direction(k, (axis + width * unit()).normalize_or(axis).to_array());
            }
            let sine = |k: u32| [1e-4, 0.03, 0.3, 1.0][k as usize];
            let cap = |k| {
                let sine_squared = f32::powi(sine(k), 2);
                BlockerCap {
                    axis: unit().lerp(axis, 0.2 * k as f32).normalize().to_array(),
                    sine_squared,
                    distance: 1.0,
                    sphere: 0,
                }
            };
            let caps = BlockerCaps([0, 1, 2, 3].map(cap).to_vec());
            caps.trace(&mut batch);
            let cone = Cone::around(batch.direction.each_ref().map(|axis| &axis[..batch.len]));
            left_out += caps.0.iter().filter(|cap| !cone.meets(cap)).count();
            for k in 0..batch.len {
                let direction = Vec3::from(batch.direction.each_ref().map(|axis| axis[k]));
                let held = caps.0.iter().any(|cap| {
                    let axis = Vec3::from(cap.axis);
                    axis.cross(direction).length_squared() < cap.sine_squared && axis.dot(direction) > 0.0
                });
                blocked += usize::from(held);
                assert_eq!(batch.visible[k] == 0.0, held, "case {case}, sample {k}");
            }
        }
        assert!(blocked > 1_000 && left_out > 1_000, "{blocked} {left_out}");
    }
}
