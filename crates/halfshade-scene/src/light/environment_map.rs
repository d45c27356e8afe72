//! A latitude-longitude map of radiance, constant over each texel.

use glam::{DVec3, Vec3};
use serde::Serialize;
use std::f32::consts::{PI, TAU};

/// Radiance over all directions on a latitude-longitude grid.
///
/// Row 0 is the zenith (+Y); the centre column looks along -Z and columns run toward +X, as a viewer inside sees
/// it. Radiance is constant over a texel: what the truth samples and what is projected are then the same function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    texels: Vec<Vec3>,
}

impl EnvironmentMap {
    /// A map of `width` by `height` texels, row by row from the zenith. `None` if the count does not fit or is 0.
    pub fn new(width: usize, height: usize, texels: Vec<Vec3>) -> Option<Self> {
        (width > 0 && height > 0 && texels.len() == width * height).then_some(Self { width, height, texels })
    }

    /// The same map, `factor` times as bright.
    pub fn scaled(&self, factor: f32) -> Self {
        Self { texels: self.texels.iter().map(|texel| factor * *texel).collect(), ..*self }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Radiance per texel, row by row from the zenith.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// The texel that unit `direction` falls in, as (column, row).
    pub fn texel_at(&self, direction: Vec3) -> (usize, usize) {
        let u = direction.x.atan2(-direction.z) / TAU + 0.5;
        let v = direction.y.clamp(-1.0, 1.0).acos() / PI;
        let column = (u * self.width as f32) as usize % self.width;
        let row = ((v * self.height as f32) as usize).min(self.height - 1);
        (column, row)
    }

    /// Unit direction of the point `(u, v)` in [0, 1]², u along columns, v along rows.
    pub fn direction_at(&self, u: f32, v: f32) -> Vec3 {
        let (sin_azimuth, cos_azimuth) = ((u - 0.5) * TAU).sin_cos();
        let (sin_polar, cos_polar) = (v * PI).sin_cos();
        Vec3::new(sin_polar * sin_azimuth, cos_polar, -sin_polar * cos_azimuth)
    }

    /// Unit direction of the middle of a texel, by its number in [`Self::texels`].
    pub fn texel_direction(&self, texel: usize) -> Vec3 {
        let (u, v) = ((texel % self.width) as f32 + 0.5, (texel / self.width) as f32 + 0.5);
        self.direction_at(u / self.width as f32, v / self.height as f32)
    }

    /// Solid angle in steradians of each texel of `row`.
    pub fn texel_solid_angle(&self, row: usize) -> f64 {
        let edge = |row: usize| (std::f64::consts::PI * row as f64 / self.height as f64).cos();
        std::f64::consts::TAU / self.width as f64 * (edge(row) - edge(row + 1))
    }

    /// Mean radiance over all directions, weighted by solid angle.
    pub fn mean_radiance(&self) -> DVec3 {
        let row_sum = |row: &[Vec3]| row.iter().map(|texel| texel.as_dvec3()).sum::<DVec3>();
        let rows = self.texels.chunks_exact(self.width).enumerate();
        let total: DVec3 = rows.map(|(row, texels)| self.texel_solid_angle(row) * row_sum(texels)).sum();
        total / (4.0 * std::f64::consts::PI)
    }

    /// Radiance along unit `direction`.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let (column, row) = self.texel_at(direction);
        self.texels[row * self.width + column]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_texels_agree() {
        let (width, height) = (8, 4);
        let map = EnvironmentMap::new(width, height, (0..32).map(|i| Vec3::splat(i as f32)).collect()).unwrap();
        for row in 0..height {
            for column in 0..width {
                let (u, v) = ((column as f32 + 0.5) / width as f32, (row as f32 + 0.5) / height as f32);
                assert_eq!(map.texel_at(map.direction_at(u, v)), (column, row));
            }
        }
        assert!(map.direction_at(0.5, 0.5).distance(Vec3::NEG_Z) < 1e-6);
        assert!(map.direction_at(0.75, 0.5).distance(Vec3::X) < 1e-6);
        let total: f64 = (0..height).map(|row| map.texel_solid_angle(row) * width as f64).sum();
        assert!((total - 4.0 * std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn the_mean_weighs_by_solid_angle() {
        let texels =
            (0..16).flat_map(|row| [Vec3::new(1.0, if row < 8 { 2.0 } else { 0.0 }, row as f32); 32]).collect();
        let map = EnvironmentMap::new(32, 16, texels).unwrap();
        assert!(map.mean_radiance().distance(DVec3::new(1.0, 1.0, 7.5)) < 1e-12);
    }
}
