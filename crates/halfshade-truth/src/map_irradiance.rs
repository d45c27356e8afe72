//! Unshadowed irradiance of an environment map by deterministic quadrature.
//!
//! `E(n) = ∫ L(ω) max(n·ω, 0) dω` is linear in n wherever a patch of the map lies wholly above the horizon, so that the
//! patch's first moment `∫ L ω dω` answers for all of it. A quadtree of such moments leaves only the cells that the
//! horizon crosses, which are evaluated at their centres, eight in a row at once. Coarse maps are divided so that cells
//! are at most 2π/1024 wide: the horizon's error is then below 1e-5 of the light along it.

use glam::{DVec3, Mat3, Quat, Vec3};
use halfshade_scene::light::EnvironmentMap;
use std::f64::consts::{PI, TAU};
use wide::f32x8;

/// Cells per side of a leaf of the quadtree: its rows fill vector registers.
const LEAF: usize = 8;
/// Fewest columns of cells.
const COLUMNS: usize = 1024;

/// A patch of the map: a cap that holds it, and its first moment per channel.
#[derive(Debug, Clone, Copy)]
struct Patch {
    center: Vec3,
    sine_of_radius: f32,
    moment: [Vec3; 3],
}

/// One level of the quadtree, row by row.
#[derive(Debug)]
struct Level {
    width: usize,
    patches: Vec<Patch>,
}

/// First moments of a map, in environment space.
#[derive(Debug)]
pub(crate) struct MapIrradiance {
    /// Levels from the leaves to one patch.
    levels: Vec<Level>,
    /// The cells of the leaves, in the order of the last level's patches.
    leaves: Vec<Leaf>,
    /// Sines and cosines of the azimuths of each leaf column's cells.
    azimuths: Vec<[f32x8; 2]>,
    /// Sine and cosine of each row's polar angle.
    polars: Vec<[f32; 2]>,
    environment_from_world: Mat3,
}

/// Radiance times solid angle of a leaf's cells, per row and channel; 0 past the map's edges.
type Leaf = [[f32x8; 3]; LEAF];

/// The cells of a map: its texels, divided until they are small enough.
struct Grid<'a> {
    map: &'a EnvironmentMap,
    /// Cells per texel along each side.
    division: usize,
    /// Columns and rows.
    cells: [usize; 2],
}

impl<'a> Grid<'a> {
    fn new(map: &'a EnvironmentMap) -> Self {
        let division = COLUMNS.div_ceil(map.width()).max((COLUMNS / 2).div_ceil(map.height()));
        Self { map, division, cells: [map.width() * division, map.height() * division] }
    }

    /// Azimuth of an edge between columns, or of anything between edges.
    fn azimuth_at(&self, edge: f64) -> f64 {
        TAU * (edge / self.cells[0] as f64 - 0.5)
    }

    /// Polar angle of an edge between rows, or of anything between edges.
    fn polar_at(&self, edge: f64) -> f64 {
        PI * edge / self.cells[1] as f64
    }

    /// Solid angle of each cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        TAU / self.cells[0] as f64 * (self.polar_at(row as f64).cos() - self.polar_at(row as f64 + 1.0).cos())
    }

    /// `∫ ω dω` over a cell, exactly: over azimuths [a, b] and polar angles [s, t] it is
    /// (P·∫sin φ, (sin²t - sin²s)/2·(b - a), -P·∫cos φ), P = ∫ sin²θ dθ.
    fn first_moment(&self, column: usize, row: usize) -> DVec3 {
        let (a, b) = (self.azimuth_at(column as f64), self.azimuth_at(column as f64 + 1.0));
        let (s, t) = (self.polar_at(row as f64), self.polar_at(row as f64 + 1.0));
        let across = 0.5 * (t - s) - 0.25 * ((2.0 * t).sin() - (2.0 * s).sin());
        DVec3::new(
            across * (a.cos() - b.cos()),
            0.5 * (t.sin().powi(2) - s.sin().powi(2)) * (b - a),
            -across * (b.sin() - a.sin()),
        )
    }

    /// The texel in which a cell lies.
    fn texel_at(&self, column: usize, row: usize) -> Vec3 {
        self.map.texels()[row / self.division * self.map.width() + column / self.division]
    }

    /// A spherical cap that holds a patch of cells: its centre and the sine of its angular radius, infinite past a right
    /// angle.
    fn cap(&self, columns: [usize; 2], rows: [usize; 2]) -> (Vec3, f32) {
        let azimuth = self.azimuth_at(0.5 * (columns[0] + columns[1]) as f64);
        let polar = self.polar_at(0.5 * (rows[0] + rows[1]) as f64);
        let center = DVec3::new(polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos());
        // Along the meridian, then along the widest parallel.
        let (first, last) = (self.polar_at(rows[0] as f64), self.polar_at(rows[1] as f64));
        let widest = (0.5 * PI).clamp(first, last).sin();
        let across = self.azimuth_at(columns[1] as f64) - self.azimuth_at(columns[0] as f64);
        let radius = 0.5 * (last - first + across * widest);
        (center.as_vec3(), if radius < 0.5 * PI { (radius.sin() + 1e-6) as f32 } else { f32::INFINITY })
    }

    /// The leaves of the quadtree, row by row, and the patch of each.
    fn leaves(&self) -> (Vec<Leaf>, Level) {
        let size = self.cells.map(|n| n.div_ceil(LEAF));
        let mut patches = Vec::with_capacity(size[0] * size[1]);
        let mut leaves = Vec::with_capacity(size[0] * size[1]);
        for leaf_row in 0..size[1] {
            for leaf_column in 0..size[0] {
                let columns = [leaf_column * LEAF, ((leaf_column + 1) * LEAF).min(self.cells[0])];
                let rows = [leaf_row * LEAF, ((leaf_row + 1) * LEAF).min(self.cells[1])];
                let mut moment = [DVec3::ZERO; 3];
                let mut leaf = [[[0.0_f32; LEAF]; 3]; LEAF];
                for row in rows[0]..rows[1] {
                    let solid_angle = self.solid_angle(row);
                    for column in columns[0]..columns[1] {
                        let texel = self.texel_at(column, row).as_dvec3().to_array();
                        let cell = self.first_moment(column, row);
                        for channel in 0..3 {
                            moment[channel] += texel[channel] * cell;
                            leaf[row % LEAF][channel][column % LEAF] = (texel[channel] * solid_angle) as f32;
                        }
                    }
                }
                leaves.push(leaf.map(|row| row.map(f32x8::new)));
                let (center, sine_of_radius) = self.cap(columns, rows);
                patches.push(Patch { center, sine_of_radius, moment: moment.map(|m| m.as_vec3()) });
            }
        }
        (leaves, Level { width: size[0], patches })
    }

    /// The level above one of `below` patches, each of its own of `span` cells along a side.
    fn parents(&self, children: &Level, below: [usize; 2], span: usize) -> Level {
        let size = below.map(|n| n.div_ceil(2));
        let mut patches = Vec::with_capacity(size[0] * size[1]);
        for row in 0..size[1] {
            for column in 0..size[0] {
                let mut moment = [DVec3::ZERO; 3];
                for child_row in 2 * row..(2 * row + 2).min(below[1]) {
                    for child_column in 2 * column..(2 * column + 2).min(below[0]) {
                        let child = &children.patches[child_row * below[0] + child_column];
                        (0..3).for_each(|channel| moment[channel] += child.moment[channel].as_dvec3());
                    }
                }
                let (center, sine_of_radius) = self.cap(
                    [column * span, ((column + 1) * span).min(self.cells[0])],
                    [row * span, ((row + 1) * span).min(self.cells[1])],
                );
                patches.push(Patch { center, sine_of_radius, moment: moment.map(|m| m.as_vec3()) });
            }
        }
        Level { width: size[0], patches }
    }
}

impl MapIrradiance {
    pub(crate) fn new(map: &EnvironmentMap, world_from_environment: Quat) -> Self {
        let grid = Grid::new(map);
        let sin_cos = |angle: f64| [angle.sin() as f32, angle.cos() as f32];
        let mut size = grid.cells.map(|n| n.div_ceil(LEAF));
        let azimuths = (0..size[0])
            .map(|leaf| {
                let of_cells: [_; LEAF] =
                    std::array::from_fn(|k| sin_cos(grid.azimuth_at((leaf * LEAF + k) as f64 + 0.5)));
                [0, 1].map(|part| f32x8::new(of_cells.map(|cell| cell[part])))
            })
            .collect();
        let polars = (0..size[1] * LEAF).map(|row| sin_cos(grid.polar_at(row as f64 + 0.5))).collect();
        let (leaves, level) = grid.leaves();
        let mut levels = vec![level];
        let mut span = LEAF;
        while size != [1, 1] {
            span *= 2;
            levels.push(grid.parents(&levels[levels.len() - 1], size, span));
            size = size.map(|n| n.div_ceil(2));
        }
        Self {
            levels,
            leaves,
            azimuths,
            polars,
            environment_from_world: Mat3::from_quat(world_from_environment.normalize()).transpose(),
        }
    }

    /// Irradiance at a receiver with the unit normal `normal` in world space.
    pub(crate) fn at(&self, normal: DVec3) -> DVec3 {
        let normal = self.environment_from_world * normal.as_vec3();
        let mut sum = DVec3::ZERO;
        self.add(normal, self.levels.len() - 1, 0, 0, &mut sum);
        sum
    }

    fn add(&self, normal: Vec3, depth: usize, column: usize, row: usize, sum: &mut DVec3) {
        let level = &self.levels[depth];
        let patch = &level.patches[row * level.width + column];
        let height = normal.dot(patch.center);
        if height <= -patch.sine_of_radius {
            return;
        }
        if height >= patch.sine_of_radius {
            *sum += DVec3::from_array(patch.moment.map(|moment| f64::from(moment.dot(normal))));
        } else if depth > 0 {
            let below = &self.levels[depth - 1];
            let rows = below.patches.len() / below.width;
            for child_row in 2 * row..(2 * row + 2).min(rows) {
                for child_column in 2 * column..(2 * column + 2).min(below.width) {
                    self.add(normal, depth - 1, child_column, child_row, sum);
                }
            }
        } else {
            let [sines, cosines] = self.azimuths[column];
            let along = normal.x * sines - normal.z * cosines;
            let mut lanes = [f32x8::ZERO; 3];
            let leaf = &self.leaves[row * level.width + column];
            for (weights, [sin_polar, cos_polar]) in leaf.iter().zip(&self.polars[row * LEAF..]) {
                let height = f32x8::splat(normal.y * cos_polar);
                let cosine = along.mul_add(f32x8::splat(*sin_polar), height).fast_max(f32x8::ZERO);
                for (lane, weight) in lanes.iter_mut().zip(weights) {
                    *lane = cosine.mul_add(*weight, *lane);
                }
            }
            *sum += DVec3::from_array(lanes.map(|lane| f64::from(lane.reduce_add())));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere_irradiance::sphere_irradiance;

    #[test]
    fn a_constant_map_gives_pi_times_its_radiance_for_every_normal() {
        for (width, height) in [(1, 1), (3, 5), (64, 32), (2000, 30)] {
            let map = EnvironmentMap::new(width, height, vec![Vec3::new(1.0, 2.0, -0.5); width * height]).unwrap();
            let irradiance = MapIrradiance::new(&map, Quat::IDENTITY);
            for i in 0..50 {
                let z = -1.0 + 2.0 * f64::from(i) / 49.0;
                let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
                let ring = (1.0 - z * z).sqrt();
                let error = irradiance.at(DVec3::new(ring * cos, z, ring * sin)) / PI - DVec3::new(1.0, 2.0, -0.5);
                assert!(error.abs().max_element() < 2e-5, "{width}x{height} {z}: {error}");
            }
        }
    }

    #[test]
    fn a_bright_pole_is_a_cap_also_when_turned() {
        // The first 40 of 180 rows: a cap of 40 degrees about the zenith of the map.
        let texels = (0..360 * 180).map(|i| if i / 360 < 40 { Vec3::X } else { Vec3::Y }).collect();
        let map = EnvironmentMap::new(360, 180, texels).unwrap();
        let turn = Quat::from_rotation_x(1.1) * Quat::from_rotation_z(-0.4);
        let irradiance = MapIrradiance::new(&map, turn);
        let axis = (turn * Vec3::Y).as_dvec3();
        for i in 0..60 {
            let (sin, cos) = (0.1 * f64::from(i)).sin_cos();
            let normal = DVec3::new(sin * 0.8, cos, sin * 0.6).normalize();
            let expected = sphere_irradiance(40_f64.to_radians().sin(), axis.dot(normal));
            let found = irradiance.at(normal);
            assert!(
                (found.x - expected).abs() < 3e-5 && (found.y - (PI - expected)).abs() < 5e-5,
                "{found} {expected}"
            );
        }
    }
}
