//! Distant light as lobes of reflectance see it: its mean, weighted by a power of the cosine, by axis and exponent.
//!
//! A level for every power of two of e + 1 has the means at the nodes of a grid whose cells are less than half as wide as the lobe. Between
//! nodes and levels they are interpolated. The light is taken in cells of 2.8 degrees: beyond an exponent of 2,000 mirrors are
//! blurred by as much.

use crate::mask::kernel::own::unfolded;
use glam::{DVec3, Vec3};
use halfshade_scene::light::{DirectionalCells, DistantLight, EnvironmentMap, OctahedralGrid};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use wide::f32x8;

/// Rows and columns of the cells of the light.
const ROWS: usize = 64;
const COLUMNS: usize = 128;

/// The last level: its lobe is about as wide as a cell.
const LAST_LEVEL: usize = 11;

/// Fewest and most cells of a grid from its centre to its side.
const FEWEST_CELLS: usize = 12;
const MOST_CELLS: usize = 64;

/// Powers below this are nothing.
const LEAST_POWER: f64 = 1e-4;

/// A cell of the light.
#[derive(Debug, Clone, Copy)]
struct Cell {
    direction: DVec3,
    /// In proportion to its solid angle.
    weight: f64,
    radiance: DVec3,
}

/// Means over lobes, in the environment's space.
#[derive(Debug, Clone)]
pub(crate) struct LobeLight {
    /// Radiance of constant light.
    pub(crate) constant: Vec3,
    /// Grids and means at their nodes, for exponents 2^level - 1; none of constant light.
    pub(crate) levels: Vec<Level>,
}

/// Means over lobes of one exponent.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    pub(crate) grid: OctahedralGrid,
    pub(crate) means: Vec<Vec3>,
}

impl LobeLight {
    pub(crate) fn new(light: &DistantLight) -> Self {
        match light {
            DistantLight::Constant(radiance) => Self { constant: *radiance, levels: Vec::new() },
            DistantLight::Map(map) => {
                let cells = cells_of(map);
                let level = |level: usize| Level::new(&cells, level);
                Self { constant: Vec3::ZERO, levels: (0..=LAST_LEVEL).map(level).collect() }
            }
        }
    }

    /// Mean radiance over a lobe about unit `axis`.
    pub(crate) fn mean(&self, axis: Vec3, exponent: f32) -> Vec3 {
        let Some(last) = self.levels.len().checked_sub(1) else { return self.constant };
        let place = (exponent + 1.0).log2().min(last as f32);
        let first = (place as usize).min(last.saturating_sub(1));
        let at = |level: &Level| -> Vec3 {
            let found = level.grid.lookup(axis);
            (0..3).map(|k| found.weights[k] * level.means[found.nodes[k]]).sum()
        };
        at(&self.levels[first]).lerp(at(&self.levels[first + 1]), place - first as f32)
    }

    /// The level for so many directions in a lobe; `None`: all are the same.
    pub(crate) fn level(&self, exponent: f32, count: usize) -> Option<&Level> {
        let last = self.levels.len().checked_sub(1)?;
        let level = ((exponent + 1.0) * count as f32).log2().round();
        self.levels.get((level as usize).min(last))
    }

    pub(crate) fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.means.as_slice())).sum()
    }
}

impl Level {
    fn new(cells: &[Cell], level: usize) -> Self {
        let exponent = (1 << level) - 1;
        let half = 4.0 * f64::from(exponent + 1).sqrt();
        let grid = OctahedralGrid::new((half as usize).clamp(FEWEST_CELLS, MOST_CELLS));
        let nodes = 0..grid.node_count();
        let means =
            nodes.into_par_iter().map(|node| mean(cells, grid.direction(node).as_dvec3().normalize(), exponent));
        Self { grid, means: means.collect() }
    }

    /// Means at the nodes next to eight directions, by channel.
    #[inline(always)]
    pub(crate) fn next_to(&self, direction: &[f32x8; 3]) -> [f32x8; 3] {
        let half = f32x8::splat(self.grid.cells() as f32);
        let [column, line] = unfolded(direction).map(|at| at.mul_add(half, half).round());
        let side = f32x8::splat((2 * self.grid.cells() + 1) as f32);
        let nodes: [i32; 8] = line.mul_add(side, column).fast_trunc_int().to_array();
        let means = nodes.map(|node| self.means[(node as usize).min(self.means.len() - 1)]);
        std::array::from_fn(|channel| f32x8::from(means.map(|mean| mean[channel])))
    }
}

/// Mean radiance over `max(axis·ω, 0)^exponent`.
fn mean(cells: &[Cell], axis: DVec3, exponent: i32) -> Vec3 {
    let least_cosine = LEAST_POWER.powf(1.0 / f64::from(exponent.max(1)));
    let reach = if exponent == 0 { 0.5 * PI } else { least_cosine.acos() };
    let row = |polar: f64| ((polar / PI * ROWS as f64) as usize).min(ROWS - 1);
    let polar = axis.y.clamp(-1.0, 1.0).acos();
    let (mut light, mut whole) = (DVec3::ZERO, 0.0);
    // Lobes narrower than a cell see the ones around.
    let margin = PI / ROWS as f64;
    for row in row((polar - reach - margin).max(0.0))..=row((polar + reach + margin).min(PI)) {
        for Cell { direction, weight, radiance } in &cells[row * COLUMNS..][..COLUMNS] {
            let along = axis.dot(*direction);
            if along > 0.0 {
                let weight = weight * along.powi(exponent);
                light += weight * *radiance;
                whole += weight;
            }
        }
    }
    (light / whole.max(f64::MIN_POSITIVE)).as_vec3()
}

/// The cells, row by row.
fn cells_of(map: &EnvironmentMap) -> Vec<Cell> {
    let lit = DirectionalCells::new(map);
    let cell = |number: usize| {
        let (sine, cosine) = (PI * ((number / COLUMNS) as f64 + 0.5) / ROWS as f64).sin_cos();
        let (sin, cos) = (TAU * (((number % COLUMNS) as f64 + 0.5) / COLUMNS as f64 - 0.5)).sin_cos();
        Cell { direction: DVec3::new(sine * sin, cosine, -sine * cos), weight: sine, radiance: DVec3::ZERO }
    };
    let mut cells: Vec<Cell> = (0..ROWS * COLUMNS).map(cell).collect();
    for (direction, vectors) in lit.direction.iter().zip(&lit.vector_irradiance) {
        let direction = direction.as_dvec3().normalize();
        let row = ((direction.y.clamp(-1.0, 1.0).acos() / PI * ROWS as f64) as usize).min(ROWS - 1);
        let turn = direction.x.atan2(-direction.z) / TAU + 0.5;
        let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        let edge = |row: usize| (PI * row as f64 / ROWS as f64).cos();
        let solid_angle = TAU / COLUMNS as f64 * (edge(row) - edge(row + 1));
        cells[row * COLUMNS + column].radiance = DVec3::from(vectors.map(|v| v.as_dvec3().length())) / solid_angle;
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_sh::quadrature::SphereQuadrature;

    #[test]
    fn constant_light_is_its_own_mean_and_a_smooth_map_s_is_that_of_quadrature() {
        let constant = EnvironmentMap::new(64, 32, vec![Vec3::new(1.0, 2.0, 3.0); 64 * 32]).unwrap();
        let lights = LobeLight::new(&DistantLight::Map(constant.into()));
        // Brighter above, where rows lie.
        let texels = (0..256 * 128).map(|i| Vec3::splat(2.0 + (PI * ((i / 256) as f64 + 0.5) / 128.0).cos() as f32));
        let smooth =
            LobeLight::new(&DistantLight::Map(EnvironmentMap::new(256, 128, texels.collect()).unwrap().into()));
        for exponent in [0.0, 2.0, 9.5, 40.0, 700.0] {
            for axis in [Vec3::Y, Vec3::new(0.6, -0.48, 0.64), Vec3::new(-0.8, 0.1, -0.59).normalize()] {
                let found = lights.mean(axis, exponent);
                assert!((found - Vec3::new(1.0, 2.0, 3.0)).abs().max_element() < 2e-3, "{exponent} {axis}: {found}");
                let (mut sum, mut whole) = (0.0, 0.0);
                for (direction, weight) in SphereQuadrature::exact_to(800).points() {
                    let power = DVec3::from(direction).dot(axis.as_dvec3()).max(0.0).powf(f64::from(exponent));
                    let power =
                        if exponent == 0.0 && DVec3::from(direction).dot(axis.as_dvec3()) <= 0.0 { 0.0 } else { power };
                    sum += weight * power * (2.0 + direction[1]);
                    whole += weight * power;
                }
                let (found, exact) = (f64::from(smooth.mean(axis, exponent).x), sum / whole);
                assert!((found - exact).abs() < 0.02, "{exponent} {axis}: {found} {exact}");
            }
        }
    }
}
