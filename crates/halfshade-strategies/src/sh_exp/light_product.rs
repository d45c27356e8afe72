//! The product of light and diffuse reflectance by normal, `L_ρ(n)` of [Guerrero2007, eq. 3.61].
//!
//! ```text
//! L_ρ(n)_i = 1/π ∫ L(ω) max(n·ω, 0) y_i(ω) dω        outgoing radiance = albedo · L_ρ(n) · V
//! ```
//!
//! projected directly, not as a product of two band-limited functions: whatever V's number of bands, nothing blocked gives
//! the exact irradiance. Constant light is a zonal function about the normal; the sun is its irradiance times the mean of
//! the basis over its cap (exact unless the horizon cuts the cap); a map is a sum over cells, tabulated over normals. All
//! in the environment's own space. A window against ringing is folded in here, since (w V)·L = V·(w L).

use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment,
    light::{DirectionalCells, DistantLight, OctahedralGrid, Sun},
};
use halfshade_sh::{basis, kernel::ShBatch, window::Window, zonal};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use wide::f32x8;

/// Light that has been multiplied with the cosine, ready to be multiplied with visibility.
#[derive(Debug, Clone)]
pub(super) struct LightProduct {
    bands: usize,
    base: DistantLight,
    sun: Option<Sun>,
    grid: OctahedralGrid,
    window: Window,
    /// Clamped cosine over π by band, times the rotation's sqrt(4π/(2l+1)) and the window: constant light.
    cosine: Vec<f32>,
    /// Per node and channel the coefficients of L_ρ; empty unless the light is a map.
    table: Vec<f32>,
    /// Channels in the table: 1 for a grey map.
    channels: usize,
    /// Mean of each basis function over the sun's cap, windowed.
    sun_basis: Vec<f32>,
}

impl LightProduct {
    pub(super) fn new(bands: usize, environment: &Environment, grid: OctahedralGrid, window: Window) -> Self {
        let cosine = (zonal::clamped_cosine(bands).iter().enumerate())
            .map(|(l, a)| (a / PI * zonal::rotation_scale(l) * window.factor(l, bands)) as f32)
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
            sun_basis: Vec::new(),
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
        if self.sun != environment.sun || self.sun_basis.is_empty() {
            self.sun = environment.sun;
            self.sun_basis = self.sun.map_or(Vec::new(), |sun| {
                let direction = sun.direction.as_dvec3().normalize_or(DVec3::Y);
                let half_sine = (0.5 * f64::from(sun.angular_radius)).sin();
                let solid_angle = TAU * 2.0 * half_sine * half_sine;
                let mut mean: Vec<f64> = zonal::cap_from_versine(self.bands, 2.0 * half_sine * half_sine);
                mean.iter_mut().for_each(|value| *value /= solid_angle);
                let mut mean = zonal::rotate_to_axis(&mean, direction.to_array());
                self.window.apply(&mut mean);
                mean.iter().map(|&value| value as f32).collect()
            });
        }
    }

    fn tabulate(&mut self) {
        let DistantLight::Map(map) = &self.base else {
            self.table = Vec::new();
            return;
        };
        self.channels = if map.texels().iter().all(|t| t.x == t.y && t.y == t.z) { 1 } else { 3 };
        let cells = DirectionalCells::new(map);
        let count = self.bands * self.bands;
        let values: Vec<f32> = (cells.direction.iter())
            .flat_map(|direction| {
                let mut values = basis::evaluate(self.bands, direction.as_dvec3().normalize().to_array());
                self.window.apply(&mut values);
                values.into_iter().map(|value| (value / PI) as f32)
            })
            .collect();
        let row = self.channels * count;
        let mut table = vec![0.0; self.grid.node_count() * row];
        let (grid, channels) = (self.grid, self.channels);
        table.par_chunks_mut(row).enumerate().for_each(|(node, row)| {
            let normal = grid.direction(node);
            for (vectors, values) in cells.vector_irradiance.iter().zip(values.chunks_exact(count)) {
                for (vector, sums) in vectors[..channels].iter().zip(row.chunks_exact_mut(count)) {
                    let irradiance = vector.dot(normal);
                    if irradiance > 0.0 {
                        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += irradiance * value);
                    }
                }
            }
        });
        self.table = table;
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.table.as_slice())
    }

    /// Outgoing radiance of eight white receivers with unit `normal` in light space and visibility `visibility`. With
    /// `clamp`, each part is held between 0 and its unshadowed value.
    #[inline(always)]
    pub(super) fn dot<const N: usize>(&self, normal: &[f32x8; 3], visibility: &ShBatch<N>, clamp: bool) -> [f32x8; 3] {
        let held = |value: f32x8, most: f32x8| if clamp { value.max(f32x8::ZERO).min(most) } else { value };
        let mut radiance = match &self.base {
            DistantLight::Constant(radiance) => {
                let at_normal = halfshade_sh::kernel::basis::<f32x8, N>(*normal);
                let mut sum = f32x8::ZERO;
                for (i, (value, visible)) in at_normal.iter().zip(visibility).enumerate() {
                    sum = (*value * f32x8::splat(self.cosine[i.isqrt()])).mul_add(*visible, sum);
                }
                let share = held(sum, f32x8::ONE);
                radiance.to_array().map(|channel| share * f32x8::splat(channel))
            }
            DistantLight::Map(_) => self.dot_table(normal, visibility, &held),
        };
        if let Some(sun) = &self.sun {
            let mut share = f32x8::ZERO;
            for (value, visible) in self.sun_basis.iter().zip(visibility) {
                share = visible.mul_add(f32x8::splat(*value), share);
            }
            let share = held(share, f32x8::ONE);
            let components = normal.map(|axis| axis.to_array());
            let irradiance: [Vec3; 8] =
                std::array::from_fn(|lane| sun.irradiance(Vec3::from(components.map(|axis| axis[lane]))));
            for (channel, sum) in radiance.iter_mut().enumerate() {
                let arriving = f32x8::from(irradiance.map(|e| e[channel] * std::f32::consts::FRAC_1_PI));
                *sum = share.mul_add(arriving, *sum);
            }
        }
        radiance
    }

    #[inline(always)]
    fn dot_table<const N: usize>(
        &self,
        normal: &[f32x8; 3],
        visibility: &ShBatch<N>,
        held: &impl Fn(f32x8, f32x8) -> f32x8,
    ) -> [f32x8; 3] {
        let components = normal.map(|axis| axis.to_array());
        let mut lanes = [[0.0f32; N]; 8];
        for (i, value) in visibility.iter().enumerate() {
            for (lane, value) in lanes.iter_mut().zip(value.to_array()) {
                lane[i] = value;
            }
        }
        let mut sums = [[0.0f32; 8]; 3];
        let mut unshadowed = [[0.0f32; 8]; 3];
        let row = self.channels * N;
        for (lane, visible) in lanes.iter().enumerate() {
            let found = self.grid.lookup(Vec3::from(components.map(|axis| axis[lane])));
            let rows = found.nodes.map(|node| &self.table[node * row..(node + 1) * row]);
            for channel in 0..self.channels {
                let [a, b, c] = rows.map(|row| -> &[f32; N] { row[channel * N..].first_chunk().unwrap_or(&[0.0; N]) });
                let [wa, wb, wc] = found.weights;
                let mut partial = [0.0f32; 8];
                for i in 0..N {
                    let value = wc.mul_add(c[i], wb.mul_add(b[i], wa * a[i]));
                    partial[i % 8] = value.mul_add(visible[i], partial[i % 8]);
                }
                sums[channel][lane] = partial.iter().sum();
                unshadowed[channel][lane] = (wa * a[0] + wb * b[0] + wc * c[0]) * (4.0 * std::f32::consts::PI).sqrt();
            }
        }
        if self.channels == 1 {
            sums = [sums[0]; 3];
            unshadowed = [unshadowed[0]; 3];
        }
        std::array::from_fn(|channel| held(f32x8::from(sums[channel]), f32x8::from(unshadowed[channel])))
    }
}
