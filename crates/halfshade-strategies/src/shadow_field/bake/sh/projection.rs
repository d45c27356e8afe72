//! Occlusion at a point as a vector of spherical harmonics: a map of rays, projected.

use crate::shadow_field::bake::basis::Basis;
use glam::Vec3;
use halfshade_sh::{basis, quadrature::SphereQuadrature};
use std::f64::consts::{PI, TAU};

/// Spherical harmonics, projected from a map of directions by latitude and longitude.
#[derive(Debug)]
pub(crate) struct ShBasis {
    /// Coefficients of a vector.
    count: usize,
    /// Unit, in the middle of their cells.
    cells: Vec<Vec3>,
    /// Per cell the basis times its solid angle.
    weighted_basis: Vec<f32>,
    /// Largest half diagonal of a cell, in radians.
    cell_radius: f32,
    mean: AbsoluteMean,
}

impl ShBasis {
    /// Vectors of so many bands, projected from `side` by `side` directions.
    pub(crate) fn new(bands: usize, side: usize) -> Self {
        let (mut cells, mut weighted_basis) = (Vec::new(), Vec::new());
        for row in 0..side {
            let edge = |row: usize| (PI * row as f64 / side as f64).cos();
            let solid_angle = TAU / side as f64 * (edge(row) - edge(row + 1));
            let (sin_polar, cos_polar) = (PI * (row as f64 + 0.5) / side as f64).sin_cos();
            for column in 0..side {
                let (sin, cos) = (TAU * (column as f64 + 0.5) / side as f64).sin_cos();
                let direction = [sin_polar * cos, cos_polar, sin_polar * sin];
                cells.push(Vec3::from(direction.map(|x| x as f32)));
                weighted_basis.extend(basis::evaluate(bands, direction).iter().map(|y| (solid_angle * y) as f32));
            }
        }
        let cell_radius = 0.5 * (PI / side as f64).hypot(TAU / side as f64) as f32;
        Self { count: bands * bands, cells, weighted_basis, cell_radius, mean: AbsoluteMean::new(bands) }
    }
}

impl Basis for ShBasis {
    type Vector = Vec<f32>;

    fn project(&self, value: &dyn Fn(Vec3) -> f32) -> Vec<f32> {
        let mut sum = vec![0.0_f32; self.count];
        for (&direction, values) in self.cells.iter().zip(self.weighted_basis.chunks_exact(self.count)) {
            let value = value(direction);
            if value != 0.0 {
                sum.iter_mut().zip(values).for_each(|(sum, y)| *sum += value * y);
            }
        }
        sum
    }

    fn cell_radius(&self) -> f32 {
        self.cell_radius
    }

    fn mix(&self, parts: &[(&Vec<f32>, f32)]) -> Vec<f32> {
        let mut sum = vec![0.0; self.count];
        for (vector, weight) in parts {
            sum.iter_mut().zip(*vector).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }

    fn difference(&self, a: &Vec<f32>, b: &Vec<f32>) -> f64 {
        self.mean.difference(a, b)
    }
}

/// Basis functions at the points of a quadrature, for integrals of absolute values.
#[derive(Debug)]
struct AbsoluteMean {
    /// Weight over 4π, and the basis there.
    points: Vec<(f32, Vec<f32>)>,
}

impl AbsoluteMean {
    fn new(bands: usize) -> Self {
        // Absolute values are no polynomials: a rule for twice the degree of a product errs by a few hundredths of them.
        let points = SphereQuadrature::exact_to(4 * bands)
            .points()
            .map(|(direction, weight)| {
                let values = basis::evaluate(bands, direction).into_iter().map(|y| y as f32).collect();
                ((weight / (4.0 * PI)) as f32, values)
            })
            .collect();
        Self { points }
    }

    fn difference(&self, a: &[f32], b: &[f32]) -> f64 {
        let at = |(weight, values): &(f32, Vec<f32>)| {
            let difference: f32 = values.iter().zip(a.iter().zip(b)).map(|(y, (a, b))| y * (a - b)).sum();
            f64::from(weight * difference.abs())
        };
        self.points.iter().map(at).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shadow_field::bake::bounds::BoundingSphere, shared::triangle_rays::TriangleRays};
    use halfshade_scene::builtin::shapes;
    use halfshade_sh::zonal;

    #[test]
    fn a_ball_hides_a_cap() {
        let rays = TriangleRays::new(&shapes::sphere(40));
        let basis = ShBasis::new(4, 128);
        let bounds = BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
        for point in [Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.5, -0.5, 1.0), Vec3::new(-6.0, 0.1, 0.2)] {
            let found = basis.blocked_from(&rays, point, bounds);
            let versine = 1.0 - (1.0 - 1.0 / f64::from(point.length_squared())).sqrt();
            let axis = (-point).as_dvec3().normalize().to_array();
            let expected = zonal::rotate_to_axis(&zonal::cap_from_versine(4, versine), axis);
            for (found, expected) in found.iter().zip(expected) {
                assert!((f64::from(*found) - expected).abs() < 0.02, "{point}: {found} {expected}");
            }
        }
        let inside = basis.blocked_from(&rays, Vec3::new(0.2, 0.1, 0.0), bounds);
        let all = halfshade_sh::basis::one(4);
        assert!(inside.iter().zip(all).all(|(value, one)| (f64::from(*value) - one).abs() < 1e-3), "{inside:?}");
    }

    /// The mean of |y_1,0| over the sphere is sqrt(3/4π)/2.
    #[test]
    fn the_mean_of_an_absolute_value() {
        let mut z = vec![0.0; 16];
        z[2] = 1.0;
        let expected = (3.0 / (4.0 * PI)).sqrt() * 0.5;
        assert!((ShBasis::new(4, 8).difference(&z, &vec![0.0; 16]) / expected - 1.0).abs() < 0.02);
    }
}
