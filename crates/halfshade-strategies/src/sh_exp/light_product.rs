//! The product of light and diffuse reflectance by normal, `L_ρ(n)` of [Guerrero2007, eq. 3.61].
//!
//! ```text
//! L_ρ(n)_i = 1/π ∫ L(ω) max(n·ω, 0) y_i(ω) dω        outgoing radiance = albedo · L_ρ(n) · V
//! ```
//!
//! projected directly, not as a product of two band-limited functions: whatever V's number of bands, nothing blocked gives
//! the exact irradiance. Constant light is a zonal function about the normal; the sun is in [`super::sun_product`]; a map
//! is a sum over cells, tabulated over normals. All in the environment's own space. A window against ringing is folded in here, since (w V)·L = V·(w L).

use super::sun_product::SunProduct;
use glam::Vec3;
use halfshade_scene::{
    Environment,
    light::{DirectionalCells, DistantLight, OctahedralGrid, is_grey},
};
use halfshade_sh::{
    basis,
    kernel::{self, LANES, ShBatch},
    window::Window,
    zonal,
};
use rayon::prelude::*;
use std::f64::consts::PI;
use wide::f32x8;

/// Light that has been multiplied with the cosine, ready to be multiplied with visibility.
#[derive(Debug, Clone)]
pub(super) struct LightProduct {
    bands: usize,
    base: DistantLight,
    sun: Option<SunProduct>,
    grid: OctahedralGrid,
    window: Window,
    /// Clamped cosine over π by band, times the rotation's sqrt(4π/(2l+1)) and the window: constant light.
    cosine: Vec<f32>,
    /// Per node and channel the coefficients of L_ρ, filled up with zeros; empty unless the light is a map.
    table: Vec<f32x8>,
    /// Channels in the table: 1 for a grey map.
    channels: usize,
}

impl LightProduct {
    pub(super) fn new(bands: usize, environment: &Environment, grid: OctahedralGrid, window: Window) -> Self {
        let cosine = (zonal::reflectance(bands).into_iter().enumerate())
            .map(|(l, value)| (value * window.factor(l, bands)) as f32)
            .collect();
        let mut product = Self {
            bands,
            base: DistantLight::Constant(Vec3::ZERO),
            sun: None,
            grid,
            window,
            cosine,
            table: Vec::new(),
            channels: 1,
        };
        product.set(environment);
        product
    }

    /// Whether `environment` is what this was made for; otherwise it is made anew.
    pub(super) fn set(&mut self, environment: &Environment) {
        if !self.base.is_same_as(&environment.base) {
            self.base = environment.base.clone();
            self.tabulate();
        }
        if !match (&self.sun, &environment.sun) {
            (Some(known), Some(sun)) => known.is_of(sun),
            (known, sun) => known.is_none() && sun.is_none(),
        } {
            self.sun = environment.sun.map(|sun| SunProduct::new(self.bands, sun, self.window));
        }
    }

    fn tabulate(&mut self) {
        let DistantLight::Map(map) = &self.base else {
            self.table = Vec::new();
            return;
        };
        self.channels = if map.texels().iter().all(|&texel| is_grey(texel)) { 1 } else { 3 };
        let cells = DirectionalCells::new(map);
        let count = self.bands * self.bands;
        let values: Vec<f32> = (cells.direction.iter())
            .flat_map(|direction| {
                let mut values = basis::evaluate(self.bands, direction.as_dvec3().normalize().to_array());
                self.window.apply(&mut values);
                values.into_iter().map(|value| (value / PI) as f32)
            })
            .collect();
        let padded = count.next_multiple_of(LANES);
        let row = self.channels * padded;
        let mut table = vec![0.0; self.grid.node_count() * row];
        let (grid, channels) = (self.grid, self.channels);
        table.par_chunks_mut(row).enumerate().for_each(|(node, row)| {
            let normal = grid.direction(node);
            for (vectors, values) in cells.vector_irradiance.iter().zip(values.chunks_exact(count)) {
                for (vector, sums) in vectors[..channels].iter().zip(row.chunks_exact_mut(padded)) {
                    let irradiance = vector.dot(normal);
                    if irradiance > 0.0 {
                        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += irradiance * value);
                    }
                }
            }
        });
        self.table = table.as_chunks::<LANES>().0.iter().map(|&row| f32x8::from(row)).collect();
    }

    /// Whether no light has a colour.
    pub(super) fn is_grey(&self) -> bool {
        let base = match &self.base {
            DistantLight::Constant(radiance) => is_grey(*radiance),
            DistantLight::Map(_) => self.channels == 1,
        };
        base && self.sun.as_ref().is_none_or(SunProduct::is_grey)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.table.as_slice())
    }

    /// Outgoing radiance of eight white receivers with unit `normal` in light space and visibility `visibility`. With
    /// `clamp`, each part is held between 0 and its unshadowed value.
    #[inline(always)]
    pub(super) fn dot<const N: usize>(&self, normal: &[f32x8; 3], visibility: &ShBatch<N>, clamp: bool) -> [f32x8; 3] {
        let mut radiance = match &self.base {
            DistantLight::Constant(radiance) => {
                let at_normal = kernel::basis::<f32x8, N>(*normal);
                let sum = kernel::dot(&kernel::times_bands(&at_normal, &self.cosine), visibility);
                let share = if clamp { sum.max(f32x8::ZERO).min(f32x8::ONE) } else { sum };
                radiance.to_array().map(|channel| share * f32x8::splat(channel))
            }
            DistantLight::Map(_) => self.dot_table(normal, visibility, clamp),
        };
        if let Some(sun) = &self.sun {
            sun.add(normal, visibility, clamp, &mut radiance);
        }
        radiance
    }

    #[inline(always)]
    fn dot_table<const N: usize>(&self, normal: &[f32x8; 3], visibility: &ShBatch<N>, clamp: bool) -> [f32x8; 3] {
        let (nodes, weights) = self.grid.lookup_batch(normal);
        let weights = weights.map(|corner| corner.to_array());
        // Per lane the sum over coefficients i = k mod 8 in element k: added up by a transpose in the end.
        let mut partial = [[f32x8::ZERO; LANES]; 3];
        let mut unshadowed = [[0.0f32; LANES]; 3];
        for part in 0..const { N.div_ceil(LANES) } {
            let coefficients = std::array::from_fn(|k| visibility.get(part * LANES + k).copied().unwrap_or_default());
            let visible = f32x8::transpose(coefficients);
            for lane in 0..LANES {
                for (channel, partial) in partial.iter_mut().enumerate().take(self.channels) {
                    let term = |corner: usize| {
                        let row = nodes[corner][lane] as usize * self.channels + channel;
                        (self.table[row * const { N.div_ceil(LANES) } + part], f32x8::splat(weights[corner][lane]))
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
        if self.channels == 1 { [sums[0]; 3] } else { sums }
    }
}
