//! Directions of surface sample points: the vertices of a geodesic sphere, each with its Voronoi cell
//! [Guerrero2007, 4.3.1 "Surface sample points" and eq. 4.18].
//!
//! The thesis draws the many directions that divide the cells at random; here they are the points of a quadrature rule,
//! whose weights add up to 4π exactly.

use glam::DVec3;
use halfshade_scene::builtin::shapes;
use halfshade_sh::{basis, quadrature::SphereQuadrature};

/// The rule is exact to this degree: 64 by 128 points, 2.8 degrees apart.
const DEGREE: usize = 127;

/// Few directions for sample points, and many for what is projected.
#[derive(Debug, Clone)]
pub(crate) struct Geodesic {
    /// Sample directions, unit, nearly even: 10n² + 2 of them.
    pub(crate) samples: Vec<DVec3>,
    /// The many directions.
    pub(crate) dense: Vec<DenseDirection>,
}

/// One of many directions.
#[derive(Debug, Clone)]
pub(crate) struct DenseDirection {
    pub(crate) direction: DVec3,
    /// The basis there times the direction's solid angle.
    pub(crate) weighted_basis: Vec<f64>,
}

impl Geodesic {
    /// For vectors of `bands` bands; each edge of an icosahedron is divided into `divisions`.
    pub(crate) fn new(bands: usize, divisions: usize) -> Self {
        let samples = shapes::sphere(divisions.max(1)).positions.iter().map(|p| p.as_dvec3().normalize()).collect();
        let dense = SphereQuadrature::exact_to(DEGREE)
            .points()
            .map(|(direction, weight)| DenseDirection {
                direction: DVec3::from_array(direction),
                weighted_basis: basis::evaluate(bands, direction).iter().map(|y| weight * y).collect(),
            })
            .collect();
        Self { samples, dense }
    }

    /// For every dense direction the nearest of the sample directions that `valid` names: its cell. `None` if none is.
    pub(crate) fn cells(&self, valid: &[usize]) -> Option<Vec<usize>> {
        let nearest = |direction: DVec3| {
            let closeness = |&&sample: &&usize| self.samples[sample].dot(direction);
            valid.iter().max_by(|a, b| closeness(a).total_cmp(&closeness(b))).copied()
        };
        self.dense.iter().map(|dense| nearest(dense.direction)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σ over cells of ∫ y dω is the projection of 1; each of 42 cells takes about a 42nd of the sphere.
    #[test]
    fn cells_divide_the_sphere() {
        let geodesic = Geodesic::new(4, 2);
        assert_eq!(geodesic.samples.len(), 42);
        let all: Vec<usize> = (0..42).collect();
        let cells = geodesic.cells(&all).unwrap();
        let mut sums = vec![vec![0.0; 16]; 42];
        for (dense, &cell) in geodesic.dense.iter().zip(&cells) {
            sums[cell].iter_mut().zip(&dense.weighted_basis).for_each(|(sum, y)| *sum += y);
        }
        for (k, one) in basis::one(4).iter().enumerate() {
            assert!((sums.iter().map(|sum| sum[k]).sum::<f64>() - one).abs() < 1e-12);
        }
        let even = basis::one(4)[0] / 42.0;
        assert!(sums.iter().all(|sum| (sum[0] / even - 1.0).abs() < 0.2));
        assert_eq!(geodesic.cells(&[]), None);
        assert!(geodesic.cells(&[7]).unwrap().iter().all(|&cell| cell == 7));
    }
}
