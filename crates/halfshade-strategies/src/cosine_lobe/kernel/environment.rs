//! Light of an environment as lobes and cells: what arrives unblocked, and what part of it spheres leave open.

use super::cover::Cover;
use crate::shared::vector::dot;
use glam::Vec3;
use halfshade_sh::lobe::{Lobe8, LobeTable};
use std::f32::consts::FRAC_1_SQRT_2;
use wide::f32x8;

/// The part of a lobe's peak that counts as nothing.
const NEGLIGIBLE: f32 = 1e-6;

/// Eight lobes of scale 1, and their colours.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lobes8 {
    pub(crate) lobe: Lobe8,
    pub(crate) color: [f32x8; 3],
}

/// Eight cells side by side. Outside of the hemisphere they have no light and no size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cells8 {
    /// Unit direction of the middle of the light.
    pub(crate) direction: [f32x8; 3],
    /// Exponent of the lobe of the cell's solid angle, `2π/Ω - 1`.
    pub(crate) exponent: f32x8,
    /// `1/Ω`, or 0 for no size.
    pub(crate) per_solid_angle: f32x8,
    /// `∫ L dω` of each channel.
    pub(crate) flux: [f32x8; 3],
}

impl Cells8 {
    /// Cosine between each direction and an axis.
    #[inline(always)]
    pub(crate) fn cosine(&self, axis: &[f32x8; 3]) -> f32x8 {
        dot(axis, &self.direction)
    }
}

/// `∫ c L dω` for a lobe c, of a constant and lobes of light.
pub(crate) fn unblocked(lobe: &Lobe8, lobes: &[Lobes8], uniform: Vec3, table: &LobeTable) -> Vec3 {
    let mut sums = [f32x8::ZERO; 3];
    for Lobes8 { lobe: light, color } in lobes {
        let integral = table.product_integral8(lobe, light);
        sums.iter_mut().zip(color).for_each(|(sum, color)| *sum = integral.mul_add(*color, *sum));
    }
    Vec3::from(sums.map(f32x8::reduce_add)) + uniform * lobe.integral().to_array()[0]
}

/// Cosine to a lobe's axis below which the lobe is negligible all over a cell, of `side` along a square.
pub(crate) fn least_cosine(lobe: &Lobe8, side: usize) -> f32 {
    let exponent = lobe.exponent.to_array()[0];
    // A cell is 4/side wide at most, and reaches half a diagonal from its middle.
    (NEGLIGIBLE.ln() / exponent.max(f32::MIN_POSITIVE)).exp() - FRAC_1_SQRT_2 * 4.0 / side as f32
}

/// The part of the light, weighted, that is open, for each channel. Cells without a weight are left out.
#[inline(always)]
pub(crate) fn open_part(
    covers: &[Cover; 2],
    cells: &[Vec<Cells8>; 2],
    weight: impl Fn(&Cells8) -> Option<f32x8>,
) -> Vec3 {
    let (mut open_sums, mut sums) = ([f32x8::ZERO; 3], [f32x8::ZERO; 3]);
    for (cover, half) in covers.iter().zip(cells) {
        for (open, cells) in cover.open().iter().zip(half) {
            let Some(weight) = weight(cells) else { continue };
            for ((open_sum, sum), flux) in open_sums.iter_mut().zip(&mut sums).zip(&cells.flux) {
                let light = weight * *flux;
                *sum += light;
                *open_sum = open.mul_add(light, *open_sum);
            }
        }
    }
    let part = |channel: usize| {
        let (open, all) = (open_sums[channel].reduce_add(), sums[channel].reduce_add());
        if all > 0.0 { (open / all).min(1.0) } else { 1.0 }
    };
    Vec3::new(part(0), part(1), part(2))
}

/// The clamped cosine in the direction of each cell; `None` if all are below the horizon.
#[inline(always)]
pub(crate) fn cosine(lobe: &Lobe8, cells: &Cells8) -> Option<f32x8> {
    let cosine = cells.cosine(&lobe.axis);
    cosine.simd_gt(f32x8::ZERO).any().then(|| cosine.fast_max(f32x8::ZERO))
}

/// The mean of a lobe about each cell; `None` if all are farther from its axis than the `least` cosine.
#[inline(always)]
pub(crate) fn mean(lobe: &Lobe8, cells: &Cells8, table: &LobeTable, least: f32) -> Option<f32x8> {
    let part = Lobe8 { axis: cells.direction, exponent: cells.exponent, scale: cells.per_solid_angle };
    let is_near = cells.cosine(&lobe.axis).simd_gt(f32x8::splat(least)).any();
    is_near.then(|| table.product_integral8(lobe, &part))
}
