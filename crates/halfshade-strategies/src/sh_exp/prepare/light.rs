//! The product of light and diffuse reflectance by normal, `L_ρ(n)` of [Guerrero2007, eq. 3.61].
//!
//! ```text
//! L_ρ(n)_i = 1/π ∫ L(ω) max(n·ω, 0) y_i(ω) dω        outgoing radiance = albedo · L_ρ(n) · V
//! ```
//!
//! projected directly, not as a product of two band-limited functions: whatever V's number of bands, nothing blocked gives
//! the exact irradiance. Constant light is a zonal function about the normal; a map is a sum over cells, tabulated over
//! normals. All in the environment's own space. A window against ringing is folded in here, since (w V)·L = V·(w L).

use crate::sh_exp::kernel::{
    light::{BaseByNormal, DistantLightByNormal},
    sun::SunLight,
};
use halfshade_scene::{
    Environment,
    light::{DirectionalCells, DistantLight, EnvironmentMap, OctahedralGrid, is_grey},
};
use halfshade_sh::{basis, kernel::LANES, window::Window, zonal};
use rayon::prelude::*;
use std::f64::consts::PI;
use wide::f32x8;

/// The light of the last frame, and what it was made of: light that stays is tabulated once.
#[derive(Debug, Clone)]
pub(crate) struct FrameLight {
    bands: usize,
    window: Window,
    base: DistantLight,
    /// How often the light was made anew.
    pub(crate) changes: u32,
    pub(crate) by_normal: DistantLightByNormal,
}

impl FrameLight {
    pub(crate) fn new(bands: usize, environment: &Environment, grid: OctahedralGrid, window: Window) -> Self {
        let cosine = (zonal::reflectance(bands).into_iter().enumerate())
            .map(|(l, value)| (value * window.factor(l, bands)) as f32)
            .collect();
        let base = by_normal(&environment.base, bands, grid, window);
        let sun = environment.sun.map(|sun| SunLight::new(bands, sun, window));
        let by_normal = DistantLightByNormal { base, sun, cosine, grid };
        Self { bands, window, base: environment.base.clone(), changes: 0, by_normal }
    }

    /// Makes the light anew where `environment` isn't that of the frame before.
    pub(crate) fn set(&mut self, environment: &Environment) {
        let Self { bands, window, base, changes, by_normal: light } = self;
        if !base.is_same_as(&environment.base) {
            *base = environment.base.clone();
            *changes += 1;
            light.base = by_normal(base, *bands, light.grid, *window);
        }
        if !match (&light.sun, &environment.sun) {
            (Some(known), Some(sun)) => known.is_of(sun),
            (known, sun) => known.is_none() && sun.is_none(),
        } {
            *changes += 1;
            light.sun = environment.sun.map(|sun| SunLight::new(*bands, sun, *window));
        }
    }
}

fn by_normal(base: &DistantLight, bands: usize, grid: OctahedralGrid, window: Window) -> BaseByNormal {
    match base {
        DistantLight::Constant(radiance) => BaseByNormal::Constant(*radiance),
        DistantLight::Map(map) => tabulated(map, bands, grid, window),
    }
}

/// A map's light at each node of the grid, as a sum over cells.
fn tabulated(map: &EnvironmentMap, bands: usize, grid: OctahedralGrid, window: Window) -> BaseByNormal {
    let channels = if map.texels().iter().all(|&texel| is_grey(texel)) { 1 } else { 3 };
    let cells = DirectionalCells::new(map);
    let count = bands * bands;
    let values: Vec<f32> = (cells.direction.iter())
        .flat_map(|direction| {
            let mut values = basis::evaluate(bands, direction.as_dvec3().normalize().to_array());
            window.apply(&mut values);
            values.into_iter().map(|value| (value / PI) as f32)
        })
        .collect();
    let padded = count.next_multiple_of(LANES);
    let row = channels * padded;
    let mut table = vec![0.0; grid.node_count() * row];
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
    BaseByNormal::Table { rows: table.as_chunks::<LANES>().0.iter().map(|&row| f32x8::from(row)).collect(), channels }
}
