//! The product of light and diffuse reflectance by normal, `L_ρ(n)` of [Guerrero2007, eq. 3.61].
//!
//! ```text
//! L_ρ(n)_i = 1/π ∫ L(ω) max(n·ω, 0) y_i(ω) dω        outgoing radiance = albedo · L_ρ(n) · V
//! ```
//!
//! projected directly, not as a product of two band-limited functions: whatever V's number of bands, nothing blocked gives
//! the exact irradiance. Constant light is a zonal function about the normal; a map is a sum over cells, tabulated over
//! normals. All in the environment's own space. A window against ringing is folded in here, since (w V)·L = V·(w L).

use crate::{
    sh_exp::kernel::{
        light::{BaseByNormal, DistantLightByNormal},
        sun::SunLight,
    },
    shared::{
        divided_light::divided,
        light_space::LightSpace,
        placed_lamps::{Lamp, placed_lamps},
    },
};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame,
    light::{DirectionalCells, DistantLight, EnvironmentMap, OctahedralGrid, Sun, is_grey},
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
    /// Most lamps that a map may have, if they and the sun are handled apart.
    most_lamps: Option<usize>,
    /// Small bright parts of the map that have been taken out of it.
    lamps: Vec<Sun>,
    base: DistantLight,
    /// How often the light was made anew.
    pub(crate) changes: u32,
    pub(crate) by_normal: DistantLightByNormal,
}

impl FrameLight {
    /// `most_lamps` may be taken out of a map and handled apart, as the sun is then; `None`: all is projected.
    pub(crate) fn new(
        bands: usize,
        environment: &Environment,
        grid: OctahedralGrid,
        window: Window,
        most_lamps: Option<usize>,
    ) -> Self {
        let cosine = (zonal::reflectance(bands).into_iter().enumerate())
            .map(|(l, value)| (value * window.factor(l, bands)) as f32)
            .collect();
        let base = environment.base.clone();
        let by_normal = DistantLightByNormal { base: BaseByNormal::Constant(Vec3::ZERO), sun: None, cosine, grid };
        let mut light = Self { bands, window, most_lamps, lamps: Vec::new(), base, changes: 0, by_normal };
        light.make_base();
        light.make_sun(light.projected_sun(environment));
        light
    }

    /// Makes the light anew where `environment` isn't that of the frame before.
    pub(crate) fn set(&mut self, environment: &Environment) {
        if !self.base.is_same_as(&environment.base) {
            self.base = environment.base.clone();
            self.changes += 1;
            self.make_base();
        }
        let projected = self.projected_sun(environment);
        if !match (&self.by_normal.sun, &projected) {
            (Some(known), Some(sun)) => known.is_of(sun),
            (known, sun) => known.is_none() && sun.is_none(),
        } {
            self.changes += 1;
            self.make_sun(projected);
        }
    }

    /// All lamps of a frame that aren't dark, in light space.
    pub(crate) fn placed_lamps(&self, frame: &Frame<'_>, space: &LightSpace) -> Vec<Lamp> {
        let sun = frame.scene.environment.sun.filter(|_| self.most_lamps.is_some());
        let suns = sun.into_iter().chain(self.lamps.iter().copied());
        placed_lamps(frame, suns, |point| space.point(point))
    }

    fn make_base(&mut self) {
        let (lamps, rest) = divided(&self.base, self.most_lamps.unwrap_or(0));
        self.lamps = lamps;
        self.by_normal.base = by_normal(&rest, self.bands, self.by_normal.grid, self.window);
    }

    /// The sun, unless it is handled apart.
    fn projected_sun(&self, environment: &Environment) -> Option<Sun> {
        environment.sun.filter(|_| self.most_lamps.is_none())
    }

    fn make_sun(&mut self, sun: Option<Sun>) {
        self.by_normal.sun = sun.map(|sun| SunLight::new(self.bands, sun, self.window));
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
