//! Lobes chosen one by one for radiance on the grid: orthogonal matching pursuit with scales that aren't negative.

use super::super::nonnegative::nonnegative_least_squares;
use super::super::{Lobe, Lobe8, LobeTable, pair::unit};
use super::grid::{CELLS, direction, solid_angle};
use crate::{basis::dot, quadrature::golden_spiral};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI};
use wide::f32x8;

/// Normals at which irradiance counts: whole groups of eight.
const NORMALS: usize = 128;

/// λ: beside how much radiance errs, how much its mean over a surface's hemisphere does.
const IRRADIANCE_WEIGHT: f64 = 1000.0;

/// Axes among which a new lobe's is sought.
const AXES: usize = 512;

/// Exponents among which a new lobe's is sought.
const EXPONENTS: [f64; 6] = [1.0, 3.0, 9.0, 27.0, 81.0, 243.0];

/// Lobes are no narrower than this: a width of 3 degrees, half a cell.
const LARGEST_EXPONENT: f64 = 400.0;

/// New lobes that would explain less than this part of the whole are not worth having.
const NEGLIGIBLE: f64 = 1e-9;

/// Values at all cells, then at all normals, times the roots of what they count for.
type Column = Vec<f32>;

const LENGTH: usize = CELLS + NORMALS;

/// Axis and exponent; the constant is the lobe of exponent -1, which no other has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub(super) axis: [f64; 3],
    pub(super) exponent: f64,
}

impl Shape {
    /// The axis moved by angles along two tangents, the exponent by its logarithm.
    pub(super) fn moved(&self, step: [f64; 3]) -> Self {
        let [x, y, z] = self.axis;
        // Two tangents, of which the first is across the smallest part of the axis.
        let t = if x.abs() < y.abs().min(z.abs()) {
            [0.0, -z, y]
        } else if y.abs() < z.abs() {
            [z, 0.0, -x]
        } else {
            [-y, x, 0.0]
        };
        let t = unit(t);
        let b = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]];
        let axis = unit(std::array::from_fn(|i| self.axis[i] + step[0] * t[i] + step[1] * b[i]));
        Self { axis, exponent: (self.exponent * step[2].exp()).clamp(0.1, LARGEST_EXPONENT) }
    }
}

/// The columns of lobes chosen so far, and what they leave of the radiance.
pub(super) struct MatchingPursuit<'a> {
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
    pub(super) shapes: Vec<Shape>,
    columns: Vec<Column>,
    pub(super) scales: Vec<[f64; 3]>,
}

impl<'a> MatchingPursuit<'a> {
    pub(super) fn new(table: &'a LobeTable, radiance: Vec<[f64; 3]>) -> Self {
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
    pub(super) fn add(&mut self) -> bool {
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
    pub(super) fn solve(&mut self, emphasis: f64) {
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
    pub(super) fn sweep(&mut self, part: f64) {
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

/// Decrease of the squares of what is left by a lobe of the best scales.
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
