//! Importance sampling of an environment map by radiance times solid angle.
//!
//! The map is constant over each texel, so its density is too: rows are chosen by their share of the map's total, columns
//! by their share of the row, and the point within the texel uniformly by solid angle. The importance of a texel is the
//! luminance of the absolute values of its channels: a band-limited light may be negative.

use crate::{
    batch::{BATCH, Batch},
    directions::sin_cos_turns,
    points::{Scramble, unit_f64},
    receiver::Receiver,
};
use glam::{Mat3, Quat, Vec3};
use halfshade_scene::light::EnvironmentMap;
use std::{f32::consts::FRAC_1_PI, f64::consts::PI};

/// Luminance of Rec. 709 primaries.
pub(crate) const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// A map, ready to be sampled and looked up.
#[derive(Debug)]
pub(crate) struct MapSampler {
    width: usize,
    height: usize,
    /// Radiance, and density per steradian with which the map technique chooses a direction of this texel.
    texels: Vec<[f32; 4]>,
    /// Rows' cumulative probability, `height + 1` values from 0 to 1.
    rows: Vec<f64>,
    /// Each row's cumulative probability over columns, without the leading 0, row by row.
    columns: Vec<f32>,
    /// Where to begin to look in `rows` and in each row of `columns`: for each of as many equal parts of [0, 1) as there
    /// are entries, the first entry that ends past the part's beginning. A search then takes a step or two.
    row_guide: Vec<u32>,
    column_guide: Vec<u32>,
    /// Cosine of the polar angle at each row's upper edge, `height + 1` values.
    row_cosines: Vec<f64>,
    environment_from_world: Mat3,
    world_from_environment: Mat3,
    black: bool,
}

impl MapSampler {
    pub(crate) fn new(map: &EnvironmentMap, world_from_environment: Quat) -> Self {
        let (width, height) = (map.width(), map.height());
        let importance = |texel: &Vec3| -> f64 {
            let size = texel.abs().to_array();
            (0..3).map(|c| f64::from(LUMINANCE[c]) * f64::from(size[c])).sum()
        };
        let row_totals: Vec<f64> = (0..height)
            .map(|row| {
                map.texels()[row * width..][..width].iter().map(importance).sum::<f64>() * map.texel_solid_angle(row)
            })
            .collect();
        let total: f64 = row_totals.iter().sum();
        let black = !(total > 0.0 && total.is_finite());

        let mut rows = Vec::with_capacity(height + 1);
        let mut columns = vec![1.0_f32; width * height];
        let mut texels: Vec<[f32; 4]> = map.texels().iter().map(|t| [t.x, t.y, t.z, 0.0]).collect();
        rows.push(0.0);
        let mut cumulative = 0.0;
        for row in 0..height {
            cumulative += row_totals[row];
            rows.push(if black { 1.0 } else { (cumulative / total).min(1.0) });
            if black || row_totals[row] <= 0.0 {
                continue;
            }
            let texel_range = row * width..(row + 1) * width;
            let row_total: f64 = map.texels()[texel_range.clone()].iter().map(importance).sum();
            let mut in_row = 0.0;
            for (cell, texel) in columns[texel_range.clone()].iter_mut().zip(&map.texels()[texel_range.clone()]) {
                in_row += importance(texel);
                *cell = (in_row / row_total).min(1.0) as f32;
            }
            // Rounding leaves the last entry a little below 1; from the last bright texel on it has to be 1.
            let last = columns[texel_range.end - 1];
            columns[texel_range.clone()].iter_mut().filter(|cell| **cell == last).for_each(|cell| *cell = 1.0);
            // The density comes from the rounded table itself, so that it is exactly what is sampled.
            let probability_per_steradian = (rows[row + 1] - rows[row]) / map.texel_solid_angle(row);
            let mut before = 0.0;
            for (texel, &after) in texels[texel_range.clone()].iter_mut().zip(&columns[texel_range]) {
                texel[3] = (probability_per_steradian * f64::from(after - before)) as f32;
                before = after;
            }
        }
        if let Some(last) = rows.last().copied() {
            rows.iter_mut().filter(|row| **row == last).for_each(|row| *row = 1.0);
        }
        let row_guide = guide(height, |row| rows[row + 1]);
        let column_guide = (0..height)
            .flat_map(|row| {
                let edges = &columns[row * width..][..width];
                guide(width, |column| f64::from(edges[column]))
            })
            .collect();
        let rotation = Mat3::from_quat(world_from_environment.normalize());
        Self {
            width,
            height,
            texels,
            rows,
            columns,
            row_guide,
            column_guide,
            row_cosines: (0..=height).map(|row| (PI * row as f64 / height as f64).cos()).collect(),
            environment_from_world: rotation.transpose(),
            world_from_environment: rotation,
            black,
        }
    }

    /// Whether no light comes from anywhere.
    pub(crate) fn is_black(&self) -> bool {
        self.black
    }

    /// Turns directions of a batch, drawn with the density cos/π, into samples: both techniques draw equally many, and
    /// the balance heuristic divides radiance times cosine by the sum of their densities.
    pub(crate) fn weigh_cosine_samples(&self, receiver: &Receiver, batch: &mut Batch) {
        let texels = self.texels_along(batch);
        self.weigh(receiver, &texels, batch);
    }

    /// The texels that the directions of a batch fall in.
    pub(crate) fn texels_along(&self, batch: &Batch) -> [usize; BATCH] {
        let m = self.environment_from_world;
        let (width, height) = (self.width as f32, self.height as f32);
        let (mut columns, mut rows) = ([0.0_f32; BATCH], [0.0_f32; BATCH]);
        let [x, y, z] = &batch.direction;
        for k in 0..BATCH {
            let e = [
                x[k] * m.x_axis.x + y[k] * m.y_axis.x + z[k] * m.z_axis.x,
                x[k] * m.x_axis.y + y[k] * m.y_axis.y + z[k] * m.z_axis.y,
                x[k] * m.x_axis.z + y[k] * m.y_axis.z + z[k] * m.z_axis.z,
            ];
            let u = turns(e[0], -e[2]) + 0.5;
            let v = 2.0 * turns((e[0] * e[0] + e[2] * e[2]).sqrt(), e[1]);
            columns[k] = u * width;
            rows[k] = v * height;
        }
        let mut texels = [0; BATCH];
        for k in 0..batch.len {
            let (column, row) = ((columns[k] as usize).min(self.width - 1), (rows[k] as usize).min(self.height - 1));
            texels[k] = row * self.width + column;
        }
        texels
    }

    /// Radiance of a texel, and the density per steradian with which the map technique chooses a direction of it.
    pub(crate) fn radiance_and_density(&self, texel: usize) -> ([f32; 3], f64) {
        let [r, g, b, density] = self.texels[texel];
        ([r, g, b], density.into())
    }

    /// Draws directions of the map technique and weighs them as [`Self::weigh_cosine_samples`] does.
    pub(crate) fn sample(&self, receiver: &Receiver, points: &[[u32; 2]], scramble: Scramble, batch: &mut Batch) {
        let texels = self.draw(points, scramble, batch);
        self.weigh(receiver, &texels, batch);
    }

    /// Draws directions of the map technique; returns their texels.
    ///
    /// Arithmetic that fills vector registers and searches in tables are loops of their own.
    pub(crate) fn draw(&self, points: &[[u32; 2]], scramble: Scramble, batch: &mut Batch) -> [usize; BATCH] {
        let (mut across, mut down) = ([0.0_f64; BATCH], [0.0_f64; BATCH]);
        for (k, &point) in points.iter().enumerate() {
            [across[k], down[k]] = scramble.apply(point).map(unit_f64);
        }
        let (mut cosines, mut texels) = ([0.0_f64; BATCH], [0; BATCH]);
        for k in 0..points.len() {
            let (row, y_in_row) = self.choose_row(down[k]);
            let (upper, lower) = (self.row_cosines[row], self.row_cosines[row + 1]);
            cosines[k] = upper + (lower - upper) * y_in_row;
            texels[k] = row * self.width;
        }
        let turns = self.choose_columns(&across, &mut texels, points.len());
        let m = self.world_from_environment;
        for k in 0..BATCH {
            // Near the zenith single precision would lose the sine.
            let sine = (1.0 - cosines[k] * cosines[k]).max(0.0).sqrt() as f32;
            // Half a turn from where the columns begin: both sine and cosine change sign.
            let (sin, cos) = sin_cos_turns(turns[k]);
            let (x, y, z) = (-sine * sin, cosines[k] as f32, sine * cos);
            batch.direction[0][k] = x * m.x_axis.x + y * m.y_axis.x + z * m.z_axis.x;
            batch.direction[1][k] = x * m.x_axis.y + y * m.y_axis.y + z * m.z_axis.y;
            batch.direction[2][k] = x * m.x_axis.z + y * m.y_axis.z + z * m.z_axis.z;
        }
        texels
    }

    /// Radiance of the texels that the directions fall in times cosine, over the sum of both techniques' densities.
    fn weigh(&self, receiver: &Receiver, texels: &[usize; BATCH], batch: &mut Batch) {
        let normal = receiver.axes.axis;
        let mut densities = [0.0; BATCH];
        for k in 0..batch.len {
            let [r, g, b, density] = self.texels[texels[k]];
            batch.set_value(k, [r, g, b]);
            densities[k] = density;
        }
        let Batch { direction: [x, y, z], value, .. } = batch;
        let mut weights = [0.0; BATCH];
        for k in 0..BATCH {
            let cosine = (x[k] * normal.x + y[k] * normal.y + z[k] * normal.z).max(0.0);
            weights[k] = cosine / (cosine * FRAC_1_PI + densities[k]).max(f32::MIN_POSITIVE);
        }
        for channel in value {
            (0..BATCH).for_each(|k| channel[k] *= weights[k]);
        }
    }

    fn choose_row(&self, y: f64) -> (usize, f64) {
        let first = self.row_guide[(y * self.height as f64) as usize] as usize;
        let row = first_past(y, first, |row| self.rows[row + 1]);
        let (low, high) = (self.rows[row], self.rows[row + 1]);
        (row, ((y - low) / (high - low)).clamp(0.0, 1.0))
    }

    /// Chooses a column in the row that begins at each texel number, adds it, and returns how far around the chosen point
    /// is, in turns from the first column.
    ///
    /// The tables are large. Reading first all guides, then all first edges, lets their delays overlap.
    fn choose_columns(&self, across: &[f64; BATCH], texels: &mut [usize; BATCH], count: usize) -> [f32; BATCH] {
        let (mut turns, begins) = ([0.0_f32; BATCH], *texels);
        for k in 0..count {
            texels[k] += self.column_guide[texels[k] + (across[k] * self.width as f64) as usize] as usize;
        }
        for k in 0..count {
            texels[k] += usize::from(f64::from(self.columns[texels[k]]) <= across[k]);
        }
        for k in 0..count {
            let (begin, x) = (begins[k], across[k]);
            let texel = first_past(x, texels[k], |texel| f64::from(self.columns[texel]));
            let low = if texel == begin { 0.0 } else { f64::from(self.columns[texel - 1]) };
            let x_in_column = ((x - low) / (f64::from(self.columns[texel]) - low)).clamp(0.0, 1.0);
            turns[k] = (((texel - begin) as f64 + x_in_column) / self.width as f64) as f32;
            texels[k] = texel;
        }
        turns
    }
}

/// The first entry from `first` on whose upper edge lies past `x`; the last edge of all is 1, which is past every `x`.
///
/// The first step, mostly the last, is taken without a branch, so that a wrong guess doesn't hold up the next search.
#[inline(always)]
fn first_past(x: f64, first: usize, upper_edge: impl Fn(usize) -> f64) -> usize {
    let mut entry = first + usize::from(upper_edge(first) <= x);
    while upper_edge(entry) <= x {
        entry += 1;
    }
    entry
}

/// For each of `count` equal parts of [0, 1), the first of `count` entries whose upper edge lies past its beginning.
fn guide(count: usize, upper_edge: impl Fn(usize) -> f64) -> Vec<u32> {
    let mut entry = 0;
    (0..count)
        .map(|part| {
            while entry + 1 < count && upper_edge(entry) <= part as f64 / count as f64 {
                entry += 1;
            }
            entry as u32
        })
        .collect()
}

/// The angle of the point (x, y) from the y axis towards the x axis, in turns from -1/2 to 1/2; absolute error below
/// 2e-8 turns. The polynomial for the arc tangent on [0, 1] is number 4.4.49 of Abramowitz and Stegun.
#[inline(always)]
fn turns(x: f32, y: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let a = ax.min(ay) / ax.max(ay).max(f32::MIN_POSITIVE);
    let s = a * a;
    let tail = 0.106_562_64 + s * (-0.075_289_64 + s * (0.042_909_614 + s * (-0.016_165_737 + s * 0.002_866_225_7)));
    let atan = a * (1.0 + s * (-0.333_331_45 + s * (0.199_935_51 + s * (-0.142_089 + s * tail))));
    let turns = atan * (0.5 * std::f32::consts::FRAC_1_PI);
    let turns = if ax > ay { 0.25 - turns } else { turns };
    let turns = if y < 0.0 { 0.5 - turns } else { turns };
    turns.copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Points;
    use glam::DVec3;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::TAU;

    fn spotty_map() -> EnvironmentMap {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let texels = (0..32 * 16)
            .map(|i| match i % 7 {
                0 => Vec3::ZERO,
                1 => Vec3::new(40.0, 10.0, -3.0),
                _ => Vec3::from_array(std::array::from_fn(|_| rng.random_range(0.0_f32..2.0))),
            })
            .collect();
        EnvironmentMap::new(32, 16, texels).unwrap()
    }

    #[test]
    fn turns_agree_with_the_standard_arc_tangent() {
        for i in -2000..=2000 {
            let angle = std::f64::consts::PI * (f64::from(i) + 0.3) / 2001.0;
            let (sin, cos) = angle.sin_cos();
            let error = f64::from(turns(3.0 * sin as f32, 3.0 * cos as f32)) - angle / TAU;
            assert!(error.abs() < 6e-8, "{angle}: {error}");
        }
        assert_eq!(turns(0.0, 0.0), 0.0);
    }

    #[test]
    fn densities_integrate_to_one_and_texels_are_drawn_in_their_share() {
        let map = spotty_map();
        let sampler = MapSampler::new(&map, Quat::from_rotation_x(0.4));
        let probability = |texel: usize| f64::from(sampler.texels[texel][3]) * map.texel_solid_angle(texel / 32);
        let total: f64 = (0..32 * 16).map(probability).sum();
        assert!((total - 1.0).abs() < 1e-6, "{total}");

        let receiver = Receiver::new(DVec3::ZERO, DVec3::ZERO, DVec3::Z);
        let (points, mut batch, mut counts) = (Points::first(1 << 14), Batch::new(), vec![0.0; 32 * 16]);
        for chunk in points.as_slice().chunks(BATCH) {
            sampler.sample(&receiver, chunk, Scramble::new(1, 2, 3, 4), &mut batch);
            for k in 0..chunk.len() {
                let direction = Vec3::from_array(std::array::from_fn(|axis| batch.direction[axis][k]));
                let (column, row) = map.texel_at(sampler.environment_from_world * direction);
                counts[row * 32 + column] += 1.0;
            }
        }
        // Low-discrepancy points miss a texel's share by a few points, not by the square root of their number.
        for (texel, &count) in counts.iter().enumerate() {
            let expected = probability(texel) * (1 << 14) as f64;
            assert!((count - expected).abs() < 12.0, "texel {texel}: {count} instead of {expected}");
        }
    }

    #[test]
    fn a_black_map_is_black() {
        let map = EnvironmentMap::new(4, 2, vec![Vec3::ZERO; 8]).unwrap();
        assert!(MapSampler::new(&map, Quat::IDENTITY).is_black());
    }
}
