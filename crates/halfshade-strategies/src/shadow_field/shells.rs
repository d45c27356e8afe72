//! Sample points on a shell, by longitude and latitude, and what lies between them.

use super::basis::Basis;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};

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
        let (places, weights) = four_nearest(self.resolution, u, v);
        basis.mix(&std::array::from_fn::<_, 4, _>(|i| (&self.samples[places[i]], weights[i])))
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

/// The four points of a grid around a place, and their weights, of sum 1: across the seam of longitudes as anywhere, and
/// over a pole to the opposite longitude. The resolution is a power of two: no division, of which shading would do much.
#[inline(always)]
pub(super) fn four_nearest(resolution: usize, u: f32, v: f32) -> ([usize; 4], [f32; 4]) {
    let size = resolution as f32;
    let (x, y) = (u * size - 0.5, v * size - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (s, t) = (x - column, y - row);
    let (column, row) = (column as i32, row as i32);
    let sides = resolution as i32;
    let at = |column: i32, row: i32| {
        let (column, row) = if row < 0 || row >= sides {
            // One point alone is its own opposite.
            (column + sides / 2, row.clamp(0, sides - 1))
        } else {
            (column, row)
        };
        (row * sides + (column & (sides - 1))) as usize
    };
    (
        [at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)],
        [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
    )
}
