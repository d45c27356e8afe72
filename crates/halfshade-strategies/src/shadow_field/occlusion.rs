//! What an object hides from a point, as a vector of spherical harmonics: a map of rays, projected.

use crate::triangle_rays::TriangleRays;
use glam::Vec3;
use halfshade_scene::Mesh;
use halfshade_sh::basis;
use std::f64::consts::{PI, TAU};

/// The directions of a map by latitude and longitude, in object space.
pub(super) struct Directions {
    pub(super) bands: usize,
    /// Unit, in the middle of its cell; and the cell's solid angle.
    pub(super) cells: Vec<(Vec3, f32)>,
    /// Per cell the basis times its solid angle.
    weighted_basis: Vec<f32>,
    /// Largest half diagonal of a cell, in radians.
    reach: f32,
}

impl Directions {
    /// `side` by `side` cells.
    pub(super) fn new(bands: usize, side: usize) -> Self {
        let (mut cells, mut weighted_basis) = (Vec::new(), Vec::new());
        for row in 0..side {
            let edge = |row: usize| (PI * row as f64 / side as f64).cos();
            let solid_angle = TAU / side as f64 * (edge(row) - edge(row + 1));
            let (sin_polar, cos_polar) = (PI * (row as f64 + 0.5) / side as f64).sin_cos();
            for column in 0..side {
                let (sin, cos) = (TAU * (column as f64 + 0.5) / side as f64).sin_cos();
                let direction = [sin_polar * cos, cos_polar, sin_polar * sin];
                cells.push((Vec3::from(direction.map(|x| x as f32)), solid_angle as f32));
                weighted_basis.extend(basis::evaluate(bands, direction).iter().map(|y| (solid_angle * y) as f32));
            }
        }
        let reach = 0.5 * (PI / side as f64).hypot(TAU / side as f64) as f32;
        Self { bands, cells, weighted_basis, reach }
    }

    /// Coefficients of a vector.
    pub(super) fn count(&self) -> usize {
        self.bands * self.bands
    }

    /// The projection of `1 - [blocked]`: 1 exactly, less the cells that are blocked.
    pub(super) fn visibility(&self, blocked: impl Fn(usize) -> bool) -> Vec<f32> {
        let mut sum = vec![0.0_f32; self.count()];
        for (cell, values) in self.weighted_basis.chunks_exact(self.count()).enumerate() {
            if blocked(cell) {
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum -= value);
            }
        }
        sum[0] += basis::one(1)[0] as f32;
        sum
    }

    /// The projection of `weight(direction)` over the cells that are not blocked; those of weight 0 aren't asked.
    pub(super) fn weighted(&self, weight: impl Fn(Vec3) -> f32, blocked: impl Fn(usize) -> bool) -> Vec<f32> {
        let mut sum = vec![0.0_f32; self.count()];
        for (cell, values) in self.weighted_basis.chunks_exact(self.count()).enumerate() {
            let weight = weight(self.cells[cell].0);
            if weight != 0.0 && !blocked(cell) {
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        sum
    }

    /// What the mesh of `rays`, which a ball about `center` of `radius` holds, leaves visible from `point`.
    pub(super) fn visibility_from(&self, rays: &TriangleRays, point: Vec3, center: Vec3, radius: f32) -> Vec<f32> {
        let offset = center - point;
        let distance = offset.length();
        // Only directions near the ball can be blocked: its angular radius and half a cell.
        let least = if distance > radius { ((radius / distance).asin() + self.reach).min(3.1).cos() } else { -1.0 };
        let toward = offset.normalize_or(Vec3::Y);
        self.visibility(|cell| {
            let direction = self.cells[cell].0;
            direction.dot(toward) >= least && rays.blocked(point, Vec3::ZERO, direction, f32::INFINITY)
        })
    }
}

/// The triangles of a mesh, in its own space.
pub(super) fn rays(mesh: &Mesh) -> TriangleRays {
    let corners = mesh.triangles.iter().map(|corners| corners.map(|vertex| mesh.positions[vertex as usize]));
    TriangleRays::new(corners.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin::shapes;
    use halfshade_sh::zonal;

    #[test]
    fn a_ball_hides_a_cap() {
        let rays = rays(&shapes::sphere(40));
        let directions = Directions::new(4, 128);
        for point in [Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.5, -0.5, 1.0), Vec3::new(-6.0, 0.1, 0.2)] {
            let found = directions.visibility_from(&rays, point, Vec3::ZERO, 1.0);
            let cosine = (1.0 - 1.0 / f64::from(point.length_squared())).sqrt();
            let axis = (-point).as_dvec3().normalize().to_array();
            let expected = zonal::rotate_to_axis(&zonal::blocker(4, cosine), axis);
            for (found, expected) in found.iter().zip(expected) {
                assert!((f64::from(*found) - expected).abs() < 0.02, "{point}: {found} {expected}");
            }
        }
        let inside = directions.visibility_from(&rays, Vec3::new(0.2, 0.1, 0.0), Vec3::ZERO, 1.0);
        assert!(inside.iter().all(|value| value.abs() < 1e-3), "{inside:?}");
    }
}
