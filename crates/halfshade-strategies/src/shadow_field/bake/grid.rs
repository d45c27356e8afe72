//! Sample points on a shell by longitude and latitude, and the vectors there.

use super::basis::Basis;
use crate::shadow_field::kernel::shell_grid::Corners;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};
use wide::f32x8;

/// Vectors on a grid over longitude and latitude, row by row from the +Y pole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Grid<V> {
    /// Points along longitude, as along latitude: a power of two.
    pub(crate) resolution: usize,
    pub(crate) samples: Vec<V>,
}

impl<V> Grid<V> {
    /// The interpolated vector.
    pub(crate) fn at<B: Basis<Vector = V>>(&self, basis: &B, [u, v]: [f32; 2]) -> V {
        let [resolution, u, v] = [self.resolution as f32, u, v].map(f32x8::splat);
        basis.mix(&Corners::new(resolution, u, v).lane(0).map(|(place, weight)| (&self.samples[place], weight)))
    }
}

/// Share of the whole in longitude and latitude at which a sample point lies.
pub(crate) fn place(resolution: usize, number: usize) -> [f32; 2] {
    let share = |i: usize| (i as f32 + 0.5) / resolution as f32;
    [share(number % resolution), share(number / resolution)]
}

/// The unit direction at a share of the whole in longitude and latitude.
pub(crate) fn direction([u, v]: [f32; 2]) -> Vec3 {
    let ((sin, cos), (sin_polar, cos_polar)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    Vec3::new(sin_polar * cos, cos_polar, sin_polar * sin)
}
