//! The plain form that the kernels are measured against: what one writes from the paper in an afternoon. Scalar f32, one
//! receiver and one sphere at a time, tables by reference, the SH product as a loop over the sparse tripling tensor.

use halfshade_scene::{Receivers, Scene, spheres::FADE_HEIGHT};
use halfshade_sh::{
    basis, exponential::Exponential, exponential::Method, logarithm, product, tripling::Triple, zonal, zonal_algebra,
};

const BANDS: usize = 4;
const COUNT: usize = BANDS * BANDS;
const ENTRIES: usize = 1024;

pub(crate) struct Plain {
    spheres: Vec<([f32; 3], f32)>,
    /// Zonal log vectors by sine of the angular radius.
    logs: Vec<[f32; BANDS]>,
    exponential: Exponential,
    tensor: Vec<Triple>,
    limit: f32,
    cosine: [f32; BANDS],
}

impl Plain {
    pub(crate) fn new(scene: &Scene, limit: f32) -> Self {
        let frame = scene.frame(0);
        let spheres = (scene.objects.iter().zip(&frame.world_from_object))
            .flat_map(|(object, pose)| {
                let set = object.spheres.iter().flat_map(|set| &set.spheres);
                set.map(move |s| (pose.transform_point(s.center).to_array(), pose.scale * s.radius))
            })
            .collect();
        let logs = (0..ENTRIES)
            .map(|i| {
                let sine = i as f64 / (ENTRIES - 1) as f64;
                let cap = zonal::cap(BANDS, (1.0 - sine * sine).sqrt());
                let log = zonal_algebra::logarithm_of_blocker(&cap, logarithm::DEFAULT_CLIP);
                std::array::from_fn(|l| (log[l] * zonal::rotation_scale(l)) as f32)
            })
            .collect();
        let cosine = zonal::clamped_cosine(BANDS);
        Self {
            spheres,
            logs,
            exponential: Exponential::new(
                BANDS,
                Method::Hybrid { magnitude_limit: f64::from(limit) },
                logarithm::DEFAULT_CLIP,
            ),
            tensor: product::tensor(BANDS).to_vec(),
            limit,
            cosine: std::array::from_fn(|l| (cosine[l] * zonal::rotation_scale(l) / std::f64::consts::PI) as f32),
        }
    }

    pub(crate) fn shade(&self, receivers: Receivers<'_>, out: &mut [f32]) {
        for (i, out) in out.iter_mut().enumerate().take(receivers.len()) {
            let (position, normal) = (receivers.position_at(i).to_array(), receivers.normal_at(i).to_array());
            let visibility = self.exponential(&self.log_sum(position, normal));
            let at_normal = self.basis(normal);
            *out = (0..COUNT).map(|i| at_normal[i] * self.cosine[i.isqrt()] * visibility[i]).sum();
        }
    }

    /// Basis values by the general recurrence, rounded to f32.
    fn basis(&self, direction: [f32; 3]) -> [f32; COUNT] {
        let mut values = [0.0; COUNT];
        basis::evaluate_into(BANDS, direction.map(f64::from), &mut values);
        values.map(|value| value as f32)
    }

    fn log_sum(&self, position: [f32; 3], normal: [f32; 3]) -> [f32; COUNT] {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut sum = [0.0; COUNT];
        for (center, radius) in &self.spheres {
            let offset: [f32; 3] = std::array::from_fn(|axis| center[axis] - position[axis]);
            let height = dot(offset, normal);
            if height <= -radius {
                continue;
            }
            let front = (0.5 * (radius + height)).min(*radius);
            let foot: [f32; 3] = std::array::from_fn(|axis| offset[axis] - height * normal[axis]);
            let mut scale = 1.0;
            if height < *radius {
                let outside = (dot(foot, foot) / (radius * radius - height * height).max(1e-12)).sqrt() - 1.0;
                scale = outside.max(height / (FADE_HEIGHT as f32 * radius)).clamp(0.0, 1.0);
            }
            let lifted = height.max(front);
            let moved: [f32; 3] = std::array::from_fn(|axis| foot[axis] + lifted * normal[axis]);
            let distance = dot(moved, moved).sqrt();
            let place = (scale * front / distance).min(1.0) * (ENTRIES - 1) as f32;
            let entry = (place as usize).min(ENTRIES - 2);
            let t = place - entry as f32;
            let at = self.basis(moved.map(|x| x / distance));
            for (i, value) in at.iter().enumerate() {
                let l = i.isqrt();
                sum[i] += ((1.0 - t) * self.logs[entry][l] + t * self.logs[entry + 1][l]) * value;
            }
        }
        sum
    }

    fn product(&self, f: &[f32; COUNT], g: &[f32; COUNT]) -> [f32; COUNT] {
        let mut h = [0.0; COUNT];
        for triple in &self.tensor {
            for [i, j, k] in triple.permutations() {
                h[i] += triple.value as f32 * f[j] * g[k];
            }
        }
        h
    }

    fn exponential(&self, f: &[f32; COUNT]) -> [f32; COUNT] {
        let full = (4.0 * std::f32::consts::PI).sqrt();
        let magnitude = f[1..].iter().map(|x| x * x).sum::<f32>().sqrt();
        let squarings = (magnitude / self.limit).max(1.0).log2().ceil() as i32;
        let scale = 0.5f32.powi(squarings);
        let (a, b) = self.exponential.table().coefficients(f64::from(magnitude * scale));
        let factor = (f[0] / full * scale).exp();
        let mut g = f.map(|value| factor * b as f32 * scale * value);
        g[0] = factor * (1.0 + a as f32) * full;
        for _ in 0..squarings {
            g = self.product(&g, &g);
        }
        g
    }
}
