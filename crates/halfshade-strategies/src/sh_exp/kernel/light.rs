//! Light times visibility, at the receiver.

use super::sun::SunLight;
use glam::Vec3;
use halfshade_scene::light::{OctahedralGrid, is_grey};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use wide::f32x8;

/// Distant light that has been multiplied with the cosine, `L_ρ(n)` of [Guerrero2007, eq. 3.61], in the environment's space.
#[derive(Debug, Clone)]
pub struct DistantLightByNormal {
    /// All but the sun.
    pub base: BaseByNormal,
    /// The sun.
    pub sun: Option<SunLight>,
    /// Clamped cosine over π by band, times the rotation's sqrt(4π/(2l+1)) and the window: constant light.
    pub cosine: Vec<f32>,
    /// Nodes of the table.
    pub grid: OctahedralGrid,
}

/// Distant light without its sun.
#[derive(Debug, Clone)]
pub enum BaseByNormal {
    /// The same radiance from everywhere.
    Constant(Vec3),
    /// Per node of the grid over normals and channel the coefficients of L_ρ, filled up with zeros.
    Table {
        /// Rows of eight coefficients.
        rows: Vec<f32x8>,
        /// 1 for grey light, else 3.
        channels: usize,
    },
}

impl DistantLightByNormal {
    /// Whether no light has a colour.
    pub(crate) fn is_grey(&self) -> bool {
        let base = match &self.base {
            BaseByNormal::Constant(radiance) => is_grey(*radiance),
            BaseByNormal::Table { channels, .. } => *channels == 1,
        };
        base && self.sun.as_ref().is_none_or(SunLight::is_grey)
    }

    pub(crate) fn bytes(&self) -> usize {
        match &self.base {
            BaseByNormal::Constant(_) => 0,
            BaseByNormal::Table { rows, .. } => size_of_val(rows.as_slice()),
        }
    }

    /// Outgoing radiance of eight white receivers with unit `normal` in light space and visibility `visibility`. With
    /// `clamp`, each part is held between 0 and its unshadowed value.
    #[inline(always)]
    pub(crate) fn dot<const N: usize>(&self, normal: &[f32x8; 3], visibility: &ShBatch<N>, clamp: bool) -> [f32x8; 3] {
        let mut radiance = match &self.base {
            BaseByNormal::Constant(radiance) => {
                let share = self.constant_share(normal, visibility, clamp);
                radiance.to_array().map(|channel| share * f32x8::splat(channel))
            }
            BaseByNormal::Table { rows, channels } => self.dot_table((rows, *channels), normal, visibility, clamp),
        };
        if let Some(sun) = &self.sun {
            sun.add(normal, visibility, clamp, &mut radiance);
        }
        radiance
    }

    /// The share of constant light that is visible, by the cosine.
    #[inline(always)]
    pub(crate) fn constant_share<const N: usize>(
        &self,
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
        clamp: bool,
    ) -> f32x8 {
        let at_normal = kernel::basis::<f32x8, N>(*normal);
        let sum = kernel::dot(&kernel::times_bands(&at_normal, &self.cosine), visibility);
        if clamp { sum.max(f32x8::ZERO).min(f32x8::ONE) } else { sum }
    }

    #[inline(always)]
    fn dot_table<const N: usize>(
        &self,
        (rows, channels): (&[f32x8], usize),
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
        clamp: bool,
    ) -> [f32x8; 3] {
        let (nodes, weights) = self.grid.lookup_batch(normal);
        let weights = weights.map(|corner| corner.to_array());
        // Per lane the sum over coefficients i = k mod 8 in element k: added up by a transpose in the end.
        let mut partial = [[f32x8::ZERO; LANES]; 3];
        let mut unshadowed = [[0.0f32; LANES]; 3];
        for part in 0..const { N.div_ceil(LANES) } {
            let coefficients = std::array::from_fn(|k| visibility.get(part * LANES + k).copied().unwrap_or_default());
            let visible = f32x8::transpose(coefficients);
            for lane in 0..LANES {
                for (channel, partial) in partial.iter_mut().enumerate().take(channels) {
                    let term = |corner: usize| {
                        let row = nodes[corner][lane] as usize * channels + channel;
                        (rows[row * const { N.div_ceil(LANES) } + part], f32x8::splat(weights[corner][lane]))
                    };
                    let ((first, a), (second, b), (third, c)) = (term(0), term(1), term(2));
                    let value = third.mul_add(c, second.mul_add(b, first * a));
                    partial[lane] = value.mul_add(visible[lane], partial[lane]);
                    if part == 0 && clamp {
                        unshadowed[channel][lane] = value.to_array()[0] * (4.0 * std::f32::consts::PI).sqrt();
                    }
                }
            }
        }
        let mut sums = partial.map(|lanes| f32x8::transpose(lanes).into_iter().fold(f32x8::ZERO, |sum, row| sum + row));
        if clamp {
            for (sum, most) in sums.iter_mut().zip(unshadowed) {
                *sum = sum.max(f32x8::ZERO).min(f32x8::from(most));
            }
        }
        if channels == 1 { [sums[0]; 3] } else { sums }
    }
}
