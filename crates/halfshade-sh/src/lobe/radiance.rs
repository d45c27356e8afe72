//! Radiance over all directions as a constant and a few coloured lobes, fitted to a latitude-longitude image.
//!
//! [Meunier2009] has lobes for spherical lights only; this is beyond it. The image is averaged over a grid of
//! [`COLUMNS`] by [`ROWS`] cells, and `L(v) = u + Σ s_j max(a_j·v, 0)^e_j` found with `u, s_j ≥ 0` that minimizes
//!
//! ```text
//! mean over directions of |L - image|²  +  λ · mean over normals of |E(L) - E(image)|²/π²
//! ```
//!
//! with irradiance E, since that is what a diffuse surface shows. Lobes are chosen one by one from a ladder of axes and
//! exponents, each the one that explains most of what is left, and all scales are fitted anew after each
//! (`nonnegative.rs`); then axes and exponents are moved to where they explain more. No step is random.

use super::nonnegative::nonnegative_least_squares;
use super::{Lobe, Lobe8, LobeTable};
use crate::{basis::dot, quadrature::golden_spiral};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use wide::f32x8;

/// Cells of the grid, 5.6 degrees wide.
const COLUMNS: usize = 64;
const ROWS: usize = 32;
const CELLS: usize = COLUMNS * ROWS;

/// Normals at which irradiance counts: whole groups of eight.
const NORMALS: usize = 128;

/// λ: beside how much radiance errs, how much its mean over a surface's hemisphere does.
const IRRADIANCE_WEIGHT: f64 = 1000.0;

/// How much more irradiance counts in the end, when axes and exponents stand: light that no lobe is narrow enough for has
/// its power then.
const EMPHASIS: f64 = 10.0;

/// Axes among which a new lobe's is sought.
const AXES: usize = 512;

/// Exponents among which a new lobe's is sought.
const EXPONENTS: [f64; 6] = [1.0, 3.0, 9.0, 27.0, 81.0, 243.0];

/// Lobes are no narrower than this: a width of 3 degrees, half a cell.
const LARGEST_EXPONENT: f64 = 400.0;

/// How often all lobes are moved.
const SWEEPS: usize = 12;

/// New lobes that would explain less than this part of the whole are not worth having.
const NEGLIGIBLE: f64 = 1e-9;

/// Values at all cells, then at all normals, times the roots of what they count for.
type Column = Vec<f32>;

const LENGTH: usize = CELLS + NORMALS;

/// A lobe of RGB radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColoredLobe {
    /// Unit axis.
    pub axis: [f64; 3],
    /// Exponent.
    pub exponent: f64,
    /// Radiance on the axis per channel, at least 0.
    pub scale: [f64; 3],
}

/// `L(v) = u + Σ_j s_j max(a_j·v, 0)^e_j` in the unit of radiance per channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LobeSum {
    /// u, the same from everywhere.
    pub uniform: [f64; 3],
    /// All others.
    pub lobes: Vec<ColoredLobe>,
}

impl LobeSum {
    /// The sum of at most `count` lobes and a constant that is near to an RGB image: by radiance, mean square over directions,
    /// and a thousand times as much by irradiance over π, mean square over normals.
    ///
    /// Row 0 is the zenith (+Y); the centre column looks along -Z and columns run toward +X, rows and columns at equal steps
    /// of polar angle and azimuth, radiance constant over a texel. Texels that are negative or not finite count as 0.
    /// `None` if `texels` does not have `width·height` entries or either is 0. The same bits on any number of
    /// threads. Light narrower than a cell of the grid is smeared over it.
    pub fn fit(count: usize, width: usize, height: usize, texels: &[[f32; 3]], table: &LobeTable) -> Option<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(texels.len()) {
            return None;
        }
        let radiance = averaged(width, height, texels);
        // Scaled to a mean of 1.
        let total: f64 = radiance.iter().enumerate().map(|(i, value)| solid_angle(i) * value.iter().sum::<f64>()).sum();
        let strength = total / (12.0 * PI);
        if strength <= 0.0 {
            return Some(Self::default());
        }
        let mut fit = Fit::new(table, radiance.iter().map(|value| value.map(|x| x / strength)).collect());
        for _ in 0..count {
            if !fit.add() {
                break;
            }
            fit.solve(1.0);
        }
        for sweep in 0..SWEEPS {
            fit.sweep(0.5f64.powi(sweep as i32 / 2));
            fit.solve(1.0);
        }
        fit.solve(EMPHASIS);
        let scaled = |scale: [f64; 3]| scale.map(|x| x * strength);
        let lobes = fit.shapes[1..].iter().zip(&fit.scales[1..]);
        Some(Self {
            uniform: scaled(fit.scales[0]),
            lobes: lobes
                .filter(|(_, scale)| scale.iter().any(|x| *x > 0.0))
                .map(|(shape, scale)| ColoredLobe { axis: shape.axis, exponent: shape.exponent, scale: scaled(*scale) })
                .collect(),
        })
    }

    /// The value in a unit direction.
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        self.lobes.iter().fold(self.uniform, |mut sum, ColoredLobe { axis, exponent, scale }| {
            let value = Lobe { axis: *axis, exponent: *exponent, scale: 1.0 }.value(direction);
            sum.iter_mut().zip(scale).for_each(|(sum, scale)| *sum += scale * value);
            sum
        })
    }
}

/// Axis and exponent; the constant is the lobe of exponent -1, which no other has.
#[derive(Debug, Clone, Copy)]
struct Shape {
    axis: [f64; 3],
    exponent: f64,
}

impl Shape {
    /// The axis moved by angles along two tangents, the exponent by its logarithm.
    fn moved(&self, step: [f64; 3]) -> Self {
        let [x, y, z] = self.axis;
        // Two tangents, of which the first is across the smallest part of the axis.
        let t = if x.abs() < y.abs().min(z.abs()) {
            [0.0, -z, y]
        } else if y.abs() < z.abs() {
            [z, 0.0, -x]
        } else {
            [-y, x, 0.0]
        };
        let t = super::pair::unit(t);
        let b = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]];
        let axis = super::pair::unit(std::array::from_fn(|i| self.axis[i] + step[0] * t[i] + step[1] * b[i]));
        Self { axis, exponent: (self.exponent * step[2].exp()).clamp(0.1, LARGEST_EXPONENT) }
    }
}

struct Fit<'a> {
    table: &'a LobeTable,
    directions: Vec<[f64; 3]>,
    /// Roots of what the cells count for.
    weights: Vec<f64>,
    normals: Vec<[f64; 3]>,
    candidates: Vec<(Shape, Column)>,
    target: [Column; 3],
    /// Radiance that no lobe explains yet.
    rest: [Column; 3],
    /// The constant first.
    shapes: Vec<Shape>,
    columns: Vec<Column>,
    scales: Vec<[f64; 3]>,
}

impl<'a> Fit<'a> {
    fn new(table: &'a LobeTable, radiance: Vec<[f64; 3]>) -> Self {
        let directions: Vec<[f64; 3]> = (0..CELLS).map(direction).collect();
        let weights: Vec<f64> = (0..CELLS).map(|i| (solid_angle(i) / (4.0 * PI)).sqrt()).collect();
        let normals: Vec<[f64; 3]> = golden_spiral(NORMALS).collect();
        let target = std::array::from_fn(|channel| {
            let value = |i: usize| radiance[i][channel];
            let cells = (0..CELLS).map(|i| (weights[i] * value(i)) as f32);
            // Weights of sum 1, so that constant radiance has just its own irradiance.
            let mean = |normal: &[f64; 3]| {
                let [sum, whole] = (0..CELLS).fold([0.0; 2], |[sum, whole], i| {
                    let weight = solid_angle(i) * dot(normal, &directions[i]).max(0.0);
                    [sum + weight * value(i), whole + weight]
                });
                sum / whole
            };
            let at_normals = normals.iter().map(|normal| (of_normals() * mean(normal)) as f32);
            cells.chain(at_normals).collect()
        });
        let constant: Column =
            weights.iter().map(|weight| *weight as f32).chain(vec![of_normals() as f32; NORMALS]).collect();
        let uniform = Shape { axis: [0.0, 1.0, 0.0], exponent: -1.0 };
        let mut fit = Self {
            table,
            directions,
            weights,
            normals,
            candidates: Vec::new(),
            rest: std::array::from_fn(|channel| Column::clone(&target[channel])),
            target,
            shapes: vec![uniform],
            columns: vec![constant],
            scales: vec![[0.0; 3]],
        };
        let ladder: Vec<Shape> =
            golden_spiral(AXES).flat_map(|axis| EXPONENTS.map(|exponent| Shape { axis, exponent })).collect();
        fit.candidates = ladder.into_par_iter().map(|shape| (shape, fit.column(&shape))).collect();
        fit.solve(1.0);
        fit
    }

    /// A lobe of scale 1.
    fn column(&self, shape: &Shape) -> Column {
        let mut column = Vec::with_capacity(LENGTH);
        column.extend(self.directions.iter().zip(&self.weights).map(|(direction, weight)| {
            let cosine = dot(&shape.axis, direction);
            if cosine > 0.0 { (weight * cosine.powf(shape.exponent)) as f32 } else { 0.0 }
        }));
        let lobe = Lobe8::splat(&Lobe { axis: shape.axis, exponent: shape.exponent, scale: of_normals() * FRAC_1_PI });
        for normals in self.normals.chunks_exact(8) {
            let axis =
                std::array::from_fn(|i| f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| normals[lane][i] as f32)));
            let cosines = Lobe8 { axis, exponent: f32x8::ONE, scale: f32x8::ONE };
            column.extend(self.table.product_integral8(&lobe, &cosines).to_array());
        }
        column
    }

    /// Adds the candidate that explains most of what is left, if any does.
    fn add(&mut self) -> bool {
        let gains: Vec<f64> = self.candidates.par_iter().map(|(_, column)| gain(column, &self.rest)).collect();
        let best = gains.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let whole: f64 = self.target.iter().map(|target| product(target, target)).sum();
        let Some((best, _)) = best.filter(|(_, gain)| **gain > NEGLIGIBLE * whole) else { return false };
        let (shape, column) = &self.candidates[best];
        self.shapes.push(*shape);
        self.columns.push(column.clone());
        self.scales.push([0.0; 3]);
        true
    }

    /// The best scales of all lobes, where irradiance counts `emphasis` times as much.
    fn solve(&mut self, emphasis: f64) {
        let count = self.columns.len();
        let product =
            |a: &Column, b: &Column| product(&a[..CELLS], &b[..CELLS]) + emphasis * product(&a[CELLS..], &b[CELLS..]);
        let gram = DMatrix::from_fn(count, count, |i, j| product(&self.columns[i], &self.columns[j]));
        for channel in 0..3 {
            let target: Vec<f64> = self.columns.iter().map(|column| product(column, &self.target[channel])).collect();
            let scales = nonnegative_least_squares(&gram, &target);
            self.rest[channel].clone_from(&self.target[channel]);
            for ((all, scale), column) in self.scales.iter_mut().zip(scales).zip(&self.columns) {
                all[channel] = scale;
                subtract(&mut self.rest[channel], column, scale);
            }
        }
    }

    /// Moves each lobe by a part of its width to where it explains most of what the others leave.
    fn sweep(&mut self, part: f64) {
        for i in 1..self.shapes.len() {
            for (rest, scale) in self.rest.iter_mut().zip(self.scales[i]) {
                subtract(rest, &self.columns[i], -scale);
            }
            let shape = self.shapes[i];
            let angle = part / (1.0 + shape.exponent).sqrt();
            let steps = [[angle, 0.0, 0.0], [0.0, angle, 0.0], [0.0, 0.0, part]];
            let moves = steps.into_iter().flat_map(|step| [step, step.map(|x| -x)]);
            let moved: Vec<Shape> = moves.map(|step| shape.moved(step)).collect();
            let columns: Vec<(f64, Shape, Column)> = moved
                .into_par_iter()
                .map(|shape| {
                    let column = self.column(&shape);
                    (gain(&column, &self.rest), shape, column)
                })
                .collect();
            let stay = gain(&self.columns[i], &self.rest);
            let best = columns.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).filter(|best| best.0 > stay);
            if let Some((_, shape, column)) = best {
                (self.shapes[i], self.columns[i]) = (shape, column);
            }
            let squared = product(&self.columns[i], &self.columns[i]);
            for channel in 0..3 {
                let scale = (product(&self.columns[i], &self.rest[channel]) / squared).max(0.0);
                self.scales[i][channel] = scale;
                subtract(&mut self.rest[channel], &self.columns[i], scale);
            }
        }
    }
}

/// By how much a lobe of the best scales lessens the squares of what is left.
fn gain(column: &Column, rest: &[Column; 3]) -> f64 {
    let explained: f64 = rest.iter().map(|rest| product(column, rest).max(0.0).powi(2)).sum();
    explained / product(column, column).max(f64::MIN_POSITIVE)
}

fn product(a: &[f32], b: &[f32]) -> f64 {
    // Eight sums side by side, each short enough for f32.
    let parts = a.chunks(128).zip(b.chunks(128)).map(|(a, b)| {
        let mut sums = [0.0f32; 8];
        for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
            sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
        }
        f64::from(sums.iter().sum::<f32>())
    });
    parts.sum()
}

fn subtract(from: &mut Column, column: &Column, scale: f64) {
    from.iter_mut().zip(column).for_each(|(value, x)| *value -= scale as f32 * x);
}

/// Root of what each normal counts for.
fn of_normals() -> f64 {
    (IRRADIANCE_WEIGHT / NORMALS as f64).sqrt()
}

/// The middle of a cell.
fn direction(cell: usize) -> [f64; 3] {
    let polar = PI * ((cell / COLUMNS) as f64 + 0.5) / ROWS as f64;
    let azimuth = TAU * (((cell % COLUMNS) as f64 + 0.5) / COLUMNS as f64 - 0.5);
    [polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()]
}

fn solid_angle(cell: usize) -> f64 {
    let edge = |row: usize| (PI * row as f64 / ROWS as f64).cos();
    TAU / COLUMNS as f64 * (edge(cell / COLUMNS) - edge(cell / COLUMNS + 1))
}

/// The image's mean over each cell of the grid, by the solid angle that each texel has in it.
fn averaged(width: usize, height: usize, texels: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let rows = overlaps(height, ROWS, |t| -(PI * t).cos());
    let columns = overlaps(width, COLUMNS, |t| t);
    let mut sums = vec![[0.0; 3]; CELLS];
    for &(row, cell_row, tall) in &rows {
        for &(column, cell_column, wide) in &columns {
            let sum = &mut sums[cell_row * COLUMNS + cell_column];
            for (sum, value) in sum.iter_mut().zip(texels[row * width + column]) {
                // NaN fails the comparison.
                if value > 0.0 && value.is_finite() {
                    *sum += tall * wide * f64::from(value);
                }
            }
        }
    }
    sums
}

/// Which of `from` intervals of [0, 1] lie in which of `to`, and what part of the latter's measure they are.
fn overlaps(from: usize, to: usize, measure: impl Fn(f64) -> f64) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::with_capacity(from + to);
    let (mut i, mut j) = (0, 0);
    while i < from && j < to {
        let low = (i as f64 / from as f64).max(j as f64 / to as f64);
        let (end, cell_end) = ((i + 1) * to, (j + 1) * from);
        let high = end.min(cell_end) as f64 / (from * to) as f64;
        let whole = measure((j + 1) as f64 / to as f64) - measure(j as f64 / to as f64);
        found.push((i, j, (measure(high) - measure(low)) / whole));
        i += usize::from(end <= cell_end);
        j += usize::from(cell_end <= end);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::ProductRule;
    use std::sync::LazyLock;

    static TABLE: LazyLock<LobeTable> = LazyLock::new(|| LobeTable::build(ProductRule::Moments));

    /// A function over a fine grid.
    fn painted(width: usize, height: usize, radiance: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f32; 3]> {
        (0..width * height)
            .map(|i| {
                let polar = PI * ((i / width) as f64 + 0.5) / height as f64;
                let azimuth = TAU * (((i % width) as f64 + 0.5) / width as f64 - 0.5);
                radiance([polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos()]).map(|x| x as f32)
            })
            .collect()
    }

    /// Irradiance over π by the midpoint rule, equal steps of sin² of the polar angle.
    fn irradiance(normal: [f64; 3], radiance: &dyn Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
        let shape = Shape { axis: normal, exponent: 1.0 };
        let (rings, spokes) = (100, 200);
        let mut sum = [0.0; 3];
        for i in 0..rings * spokes {
            let sine_squared = (f64::from(i / spokes) + 0.5) / f64::from(rings);
            let tangent = (sine_squared / (1.0 - sine_squared)).sqrt();
            let (s, c) = (TAU * f64::from(i % spokes) / f64::from(spokes) + 0.6 * f64::from(i / spokes)).sin_cos();
            let value = radiance(shape.moved([tangent * c, tangent * s, 0.0]).axis);
            sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value / f64::from(rings * spokes));
        }
        sum
    }

    /// A sky, a warm window, and a small bright lamp, soft at their edges.
    fn room(direction: [f64; 3]) -> [f64; 3] {
        let panel = |axis: [f64; 3], radius: f64, softness: f64| {
            let angle = dot(&super::super::pair::unit(axis), &direction).clamp(-1.0, 1.0).acos();
            ((radius - angle) / softness + 0.5).clamp(0.0, 1.0)
        };
        let sky = 0.6 + 0.4 * direction[1];
        let (window, lamp) = (panel([1.0, 0.6, 0.3], 0.4, 0.2), panel([-0.3, 1.0, 0.8], 0.12, 0.1));
        [
            0.5 * sky + 5.0 * window + 20.0 * lamp,
            0.6 * sky + 4.0 * window + 20.0 * lamp,
            sky + 2.0 * window + 22.0 * lamp,
        ]
    }

    /// Largest error of irradiance over its mean, and RMS error of radiance over its RMS.
    fn errors(count: usize) -> (f64, f64) {
        let texels = painted(256, 128, room);
        let sum = LobeSum::fit(count, 256, 128, &texels, &TABLE).unwrap();
        assert!(sum.lobes.len() <= count);
        let (mut worst, mut mean) = (0.0f64, 0.0);
        for normal in golden_spiral(40) {
            let (found, exact) = (irradiance(normal, &|v| sum.radiance(v)), irradiance(normal, &room));
            (0..3).for_each(|i| worst = worst.max((found[i] - exact[i]).abs()));
            mean += exact.iter().sum::<f64>() / 120.0;
        }
        let (mut squares, mut whole) = (0.0, 0.0);
        for direction in golden_spiral(2000) {
            let (found, exact) = (sum.radiance(direction), room(direction));
            squares += (0..3).map(|i| (found[i] - exact[i]).powi(2)).sum::<f64>();
            whole += exact.iter().map(|x| x * x).sum::<f64>();
        }
        (worst / mean, (squares / whole).sqrt())
    }

    #[test]
    fn irradiance_and_radiance_are_near_and_nearer_with_more_lobes() {
        let found = [2, 4, 8, 16, 32].map(errors);
        let bounds = [(0.2, 0.9), (0.15, 0.45), (0.025, 0.25), (0.007, 0.17), (0.003, 0.14)];
        for ((irradiance, radiance), bound) in found.into_iter().zip(bounds) {
            assert!(irradiance < bound.0 && radiance < bound.1, "{found:?}");
        }
    }

    #[test]
    fn a_constant_is_a_constant_and_a_lobe_a_lobe() {
        let constant = LobeSum::fit(8, 5, 3, &[[0.5, 2.0, 0.0]; 15], &TABLE).unwrap();
        assert!(constant.lobes.is_empty(), "{constant:?}");
        for (found, expected) in constant.uniform.iter().zip([0.5, 2.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
        let lobe = Lobe { axis: super::super::pair::unit([1.0, 0.4, -0.7]), exponent: 30.0, scale: 3.0 };
        let texels = painted(256, 128, |v| [lobe.value(v), 0.5 * lobe.value(v), 0.0]);
        let found = LobeSum::fit(1, 256, 128, &texels, &TABLE).unwrap();
        let only = found.lobes[0];
        assert!(dot(&only.axis, &lobe.axis) > 0.9999 && (only.exponent / lobe.exponent).ln().abs() < 0.05, "{found:?}");
        assert!((only.scale[0] - 3.0).abs() < 0.1 && (only.scale[1] - 1.5).abs() < 0.05 && only.scale[2] == 0.0);
    }

    #[test]
    fn extremes() {
        assert_eq!(LobeSum::fit(4, 2, 2, &[[1.0; 3]; 3], &TABLE), None);
        assert_eq!(LobeSum::fit(4, 0, 0, &[], &TABLE), None);
        assert_eq!(LobeSum::fit(4, 2, 2, &[[0.0; 3]; 4], &TABLE), Some(LobeSum::default()));
        assert!(LobeSum::fit(0, 2, 1, &[[1.0; 3], [3.0; 3]], &TABLE).unwrap().lobes.is_empty());
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(LobeSum::fit(4, 2, 1, &[[bad; 3], [0.0; 3]], &TABLE), Some(LobeSum::default()));
        }
        // One texel of 1e6 and one of the smallest numbers there are.
        for strength in [1e6, 1e-38, 1e38] {
            let mut texels = vec![[0.0f32; 3]; 512 * 256];
            texels[40 * 512 + 100] = [strength; 3];
            let found = LobeSum::fit(16, 512, 256, &texels, &TABLE).unwrap();
            let power: f64 = found.lobes.iter().map(|lobe| lobe.scale[0] * TAU / (lobe.exponent + 1.0)).sum();
            let edge = |row: usize| (PI * row as f64 / 256.0).cos();
            let exact = f64::from(strength) * TAU / 512.0 * (edge(40) - edge(41));
            assert!((power / exact - 1.0).abs() < 0.1, "{power} {exact} {found:?}");
        }
    }

    #[test]
    fn an_average_keeps_power() {
        for (width, height) in [(1, 1), (3, 7), (64, 32), (100, 47), (200, 90)] {
            let texels: Vec<[f32; 3]> =
                (0..width * height).map(|i| [(i * 7 % 11) as f32, 1.0, (i % 3) as f32]).collect();
            let cells = averaged(width, height, &texels);
            let edge = |row: usize| (PI * row as f64 / height as f64).cos();
            let power = |channel: usize| {
                let of =
                    |i: usize| f64::from(texels[i][channel]) * (edge(i / width) - edge(i / width + 1)) / width as f64;
                TAU * (0..width * height).map(of).sum::<f64>()
            };
            for channel in 0..3 {
                let found: f64 = cells.iter().enumerate().map(|(i, cell)| solid_angle(i) * cell[channel]).sum();
                assert!((found - power(channel)).abs() <= 1e-9 * found, "{width} {height}");
            }
        }
    }
}
