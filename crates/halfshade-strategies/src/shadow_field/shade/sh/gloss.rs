//! BRDFs as SH vectors: what receivers reflect beside their diffuse part.

use super::batch::Batch;
use crate::{shadow_field::prepare::frame::FrameData, shared::cosine_power::cosine_power};
use glam::Vec3;
use halfshade_scene::{EyeLobes, Lobes, lobe::MAX_LOBES};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use std::f32::consts::PI;
use wide::f32x8;

/// Glossy lobes of eight receivers, the k-th of each side by side.
pub(crate) struct GlossBatch<const N: usize> {
    /// The largest number of lobes that one of them has.
    pub(crate) count: usize,
    /// ρ̂ of each lobe: its power times the cosine, or the horizon.
    pub(crate) shapes: [ShBatch<N>; MAX_LOBES],
    /// Red, green, blue.
    pub(crate) scales: [[f32x8; 3]; MAX_LOBES],
}

impl<const N: usize> GlossBatch<N> {
    /// Lobes of receivers whose `cosine` is known: clamped, over π. In light space.
    pub(crate) fn new(frame: &FrameData, eye_lobes: &EyeLobes, batch: &Batch<'_>, cosine: &ShBatch<N>) -> Self {
        let lobes: [Lobes; LANES] = std::array::from_fn(|k| eye_lobes.at(&batch.receivers, batch.number(k)));
        let count = lobes.iter().map(|lobes| lobes.len()).max().unwrap_or(0).min(MAX_LOBES);
        let mut gloss = Self { count, shapes: [[f32x8::ZERO; N]; MAX_LOBES], scales: [[f32x8::ZERO; 3]; MAX_LOBES] };
        let horizon = cosine_power::<N>(batch.normal, f32x8::ZERO);
        for number in 0..count {
            let mut axes = [Vec3::Y; LANES];
            let mut exponents = [0.0; LANES];
            let mut scales = [[0.0; LANES]; 3];
            let mut times_cosine = [0.0_f32; LANES];
            for (k, lobes) in lobes.iter().enumerate() {
                let Some(lobe) = lobes.get(number) else { continue };
                axes[k] = frame.direction(lobe.axis);
                exponents[k] = lobe.exponent;
                (0..3).for_each(|channel| scales[channel][k] = lobe.scale[channel]);
                times_cosine[k] = f32::from(u8::from(lobe.times_cosine));
            }
            let axis = std::array::from_fn(|i| f32x8::from(axes.map(|axis| axis[i])));
            let power = cosine_power::<N>(axis, exponents.into());
            let with_cosine = f32x8::from(times_cosine).simd_gt(f32x8::ZERO);
            let above: ShBatch<N> =
                std::array::from_fn(|i| with_cosine.select(cosine[i] * f32x8::splat(PI), horizon[i]));
            gloss.shapes[number] = kernel::product(&power, &above);
            gloss.scales[number] = scales.map(f32x8::from);
        }
        gloss
    }
}
