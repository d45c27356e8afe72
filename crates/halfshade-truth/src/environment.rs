//! Importance sampling of an environment map by radiance times solid angle.
//!
//! The map is constant over each texel, so its density is too: rows are chosen by their share of the map's total, columns
//! by their share of the row, and the point within the texel uniformly by solid angle. The importance of a texel is the
//! luminance of the absolute values of its channels: a band-limited light may be negative.

use crate::{
    batch::Batch,
    directions::sin_cos_turns,
    points::{Scramble, unit_f64},
    receiver::Receiver,
};
use glam::{Mat3, Quat, Vec3};
use halfshade_scene::light::EnvironmentMap;
use std::f64::consts::PI;

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
        let normal = receiver.axes.axis;
        let m = self.environment_from_world;
        let mut texel_of = [0_u32; crate::batch::BATCH];
        let mut cosine_of = [0.0_f32; crate::batch::BATCH];
        let (width, height) = (self.width as f32, self.height as f32);
        for k in 0..crate::batch::BATCH {
            let [x, y, z] = [batch.direction[0][k], batch.direction[1][k], batch.direction[2][k]];
            cosine_of[k] = (x * normal.x + y * normal.y + z * normal.z).max(0.0);
            let e = [
                x * m.x_axis.x + y * m.y_axis.x + z * m.z_axis.x,
                x * m.x_axis.y + y * m.y_axis.y + z * m.z_axis.y,
                x * m.x_axis.z + y * m.y_axis.z + z * m.z_axis.z,
            ];
            let u = turns(e[0], -e[2]) + 0.5;
            let v = 2.0 * turns((e[0] * e[0] + e[2] * e[2]).sqrt(), e[1]);
            let column = (u * width).clamp(0.0, width - 1.0) as u32;
            let row = (v * height).clamp(0.0, height - 1.0) as u32;
            texel_of[k] = row * self.width as u32 + column;
        }
        for k in 0..batch.len {
            let [r, g, b, density] = self.texels[texel_of[k] as usize];
            let weight = cosine_of[k] / (cosine_of[k] * std::f32::consts::FRAC_1_PI + density).max(f32::MIN_POSITIVE);
            batch.set_value(k, [r * weight, g * weight, b * weight]);
        }
    }

    /// Draws directions of the map technique and weighs them as [`Self::weigh_cosine_samples`] does.
    pub(crate) fn sample(&self, receiver: &Receiver, points: &[[u32; 2]], scramble: Scramble, batch: &mut Batch) {
        let normal = receiver.axes.axis;
        for (k, &point) in points.iter().enumerate() {
            let [x, y] = scramble.apply(point).map(unit_f64);
            let (row, y_in_row) = self.choose_row(y);
            let (column, x_in_column) = self.choose_column(row, x);
            let (upper, lower) = (self.row_cosines[row], self.row_cosines[row + 1]);
            let cosine = upper + (lower - upper) * y_in_row;
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            // Half a turn from where the columns begin: both sine and cosine change sign.
            let (sin, cos) = sin_cos_turns(((column as f64 + x_in_column) / self.width as f64) as f32);
            let sine = sine as f32;
            let direction = Vec3::new(-sine * sin, cosine as f32, sine * cos);
            let direction = self.world_from_environment * direction;
            let cosine = direction.dot(normal).max(0.0);
            let [r, g, b, density] = self.texels[row * self.width + column];
            let weight = cosine / (cosine * std::f32::consts::FRAC_1_PI + density).max(f32::MIN_POSITIVE);
            batch.set_direction(k, direction.to_array());
            batch.set_value(k, [r * weight, g * weight, b * weight]);
        }
    }

    fn choose_row(&self, y: f64) -> (usize, f64) {
        let mut row = self.row_guide[(y * self.height as f64) as usize] as usize;
        while row + 1 < self.height && self.rows[row + 1] <= y {
            row += 1;
        }
        let (low, high) = (self.rows[row], self.rows[row + 1]);
        (row, ((y - low) / (high - low)).clamp(0.0, 1.0))
    }

    fn choose_column(&self, row: usize, x: f64) -> (usize, f64) {
        let columns = &self.columns[row * self.width..][..self.width];
        let mut column = self.column_guide[row * self.width + (x * self.width as f64) as usize] as usize;
        while column + 1 < self.width && f64::from(columns[column]) <= x {
            column += 1;
        }
        let low = if column == 0 { 0.0 } else { f64::from(columns[column - 1]) };
        (column, ((x - low) / (f64::from(columns[column]) - low)).clamp(0.0, 1.0))
    }
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
    use crate::batch::BATCH;
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

        let receiver = Receiver::new(glam::Vec3A::ZERO, DVec3::ZERO, DVec3::Z);
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
