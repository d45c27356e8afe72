//! Radiance of objects without spheres, as an affine function of the receiver's place.

use super::dot_shared;
use crate::shared::vector::dot;
use halfshade_sh::kernel::{self, ShBatch};
use wide::f32x8;

/// The surroundings of an object, as an affine function of the place.
#[derive(Debug, Clone)]
pub struct GroundField {
    /// In light space, as the blockers are.
    pub center: [f32; 3],
    /// Gradients of the places' three coordinates, which are ±1 at the places around the middle.
    pub axes: [[f32; 3]; 3],
    /// G at the middle and its change along each axis, per channel.
    pub coefficients: [[Vec<f32>; 3]; 4],
}

impl GroundField {
    /// `Σ_i (ρ_n * V)_i G_i` of eight white receivers at `position` in light space, by channel, from `weights` = ρ_n * V.
    #[inline(always)]
    pub(crate) fn radiance<const N: usize>(&self, position: &[f32x8; 3], weights: &ShBatch<N>) -> [f32x8; 3] {
        let offset: [f32x8; 3] = std::array::from_fn(|k| position[k] - f32x8::splat(self.center[k]));
        let along = self.axes.map(|axis| dot(&axis.map(f32x8::splat), &offset));
        std::array::from_fn(|channel| {
            let part = |k: usize| dot_shared(weights, &self.coefficients[k][channel]);
            part(0) + dot(&along, &[part(1), part(2), part(3)])
        })
    }
}

/// ρ_n * V: the reflectance of eight receivers with unit `normal`, by `cosine` over π per band, times visibility.
#[inline(always)]
pub(crate) fn visible_reflectance<const N: usize>(
    normal: &[f32x8; 3],
    cosine: &[f32],
    visibility: &ShBatch<N>,
) -> ShBatch<N> {
    kernel::product(&kernel::times_bands(&kernel::basis::<f32x8, N>(*normal), cosine), visibility)
}
