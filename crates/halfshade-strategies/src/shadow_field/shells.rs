//! Sample points on a shell, by longitude and latitude, and what lies between them.

use super::basis::Basis;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};
use wide::{f32x8, i32x8};

/// Vectors on a grid over longitude and latitude, row by row from the +Y pole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Grid<V> {
    /// Points along longitude, as along latitude: a power of two.
    pub(super) resolution: usize,
    pub(super) samples: Vec<V>,
}

impl<V> Grid<V> {
    /// The interpolated vector.
    pub(super) fn at<B: Basis<Vector = V>>(&self, basis: &B, [u, v]: [f32; 2]) -> V {
        let [resolution, u, v] = [self.resolution as f32, u, v].map(f32x8::splat);
        basis.mix(&Corners::new(resolution, u, v).lane(0).map(|(place, weight)| (&self.samples[place], weight)))
    }
}

/// Share of the whole in longitude and latitude at which a sample point lies.
pub(super) fn place(resolution: usize, number: usize) -> [f32; 2] {
    let share = |i: usize| (i as f32 + 0.5) / resolution as f32;
    [share(number % resolution), share(number / resolution)]
}

/// The unit direction at a share of the whole in longitude and latitude.
pub(super) fn direction([u, v]: [f32; 2]) -> Vec3 {
    let ((sin, cos), (sin_polar, cos_polar)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    Vec3::new(sin_polar * cos, cos_polar, sin_polar * sin)
}

/// Around each of eight places the four points of a grid, and their weights, of sum 1.
#[derive(Debug)]
pub(super) struct Corners {
    places: [i32x8; 4],
    weights: [f32x8; 4],
}

impl Corners {
    /// Across the seam of longitudes as anywhere, and over a pole to the opposite longitude. The resolutions are powers of
    /// two: no division.
    #[inline(always)]
    pub(super) fn new(resolution: f32x8, u: f32x8, v: f32x8) -> Self {
        let half = f32x8::HALF;
        let (x, y) = (u.mul_sub(resolution, half), v.mul_sub(resolution, half));
        let (column, row) = (x.floor(), y.floor());
        let (s, t) = (x - column, y - row);
        let sides = resolution.fast_trunc_int();
        let at = |column: f32x8, row: f32x8| {
            let over = row.simd_lt(f32x8::ZERO) | row.simd_ge(resolution);
            // One point alone is its own opposite: what is half a column too many is cut off.
            let column = column + over.select(half * resolution, f32x8::ZERO);
            let row = row.fast_min(resolution - f32x8::ONE).fast_max(f32x8::ZERO);
            row.fast_trunc_int() * sides + (column.fast_trunc_int() & (sides - i32x8::ONE))
        };
        let one = f32x8::ONE;
        let (next_column, next_row) = (column + one, row + one);
        Self {
            places: [at(column, row), at(next_column, row), at(column, next_row), at(next_column, next_row)],
            weights: [(one - s) * (one - t), s * (one - t), (one - s) * t, s * t],
        }
    }

    /// Of one lane.
    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> [(usize, f32); 4] {
        std::array::from_fn(|i| (self.places[i].as_array()[k] as usize, self.weights[i].as_array()[k]))
    }
}
