//! Adaptive sampling of a shell [Tamura2006, 4]: fewer points, as long as those there were are still known well enough.

use super::field::{Grid, four_nearest};
use halfshade_sh::{basis, quadrature::SphereQuadrature};

/// Basis functions at the points of a quadrature, for integrals of absolute values.
pub(super) struct AbsoluteMean {
    /// Weight over 4π, and the basis there.
    points: Vec<(f32, Vec<f32>)>,
}

impl AbsoluteMean {
    pub(super) fn new(bands: usize) -> Self {
        // Absolute values are no polynomials: a rule for twice the degree of a product errs by a few hundredths of them.
        let points = SphereQuadrature::exact_to(4 * bands)
            .points()
            .map(|(direction, weight)| {
                let values = basis::evaluate(bands, direction).into_iter().map(|y| y as f32).collect();
                ((weight / (4.0 * std::f64::consts::PI)) as f32, values)
            })
            .collect();
        Self { points }
    }

    /// `1/4π ∫ |Σ_g (a_g - b_g) Ψ_g(ω)| dω` [Tamura2006, eq. 1].
    fn difference(&self, a: &[f32], b: &[f32]) -> f64 {
        let at = |(weight, values): &(f32, Vec<f32>)| {
            let difference: f32 = values.iter().zip(a.iter().zip(b)).map(|(y, (a, b))| y * (a - b)).sum();
            f64::from(weight * difference.abs())
        };
        self.points.iter().map(at).sum()
    }
}

/// The coarsest of the halved grids that still gives every vector of `samples` within `threshold`.
///
/// Every halving is made from the grid before it, and tested against all original samples.
pub(super) fn thinned(samples: Grid, threshold: f64, mean: &AbsoluteMean) -> Grid {
    let mut best = samples.clone();
    while best.resolution > 1 {
        let half = halved(&best);
        let close = |place: usize| {
            let [u, v] = samples.place(place);
            mean.difference(&half.at(u, v), samples.vector(place)) < threshold
        };
        if !(0..samples.resolution * samples.resolution).all(close) {
            break;
        }
        best = half;
    }
    best
}

/// Half the resolution; each new point is the mean of the four old ones around it.
fn halved(grid: &Grid) -> Grid {
    let resolution = grid.resolution / 2;
    let mut half = Grid { resolution, count: grid.count, values: Vec::new() };
    for place in 0..resolution * resolution {
        let [u, v] = half.place(place);
        half.values.extend(grid.at(u, v));
    }
    half
}

impl Grid {
    /// Share of the whole in longitude and latitude at which a point lies.
    pub(super) fn place(&self, place: usize) -> [f32; 2] {
        let share = |i: usize| (i as f32 + 0.5) / self.resolution as f32;
        [share(place % self.resolution), share(place / self.resolution)]
    }

    pub(super) fn vector(&self, place: usize) -> &[f32] {
        &self.values[place * self.count..][..self.count]
    }

    /// The interpolated vector.
    pub(super) fn at(&self, u: f32, v: f32) -> Vec<f32> {
        let mut sum = vec![0.0; self.count];
        let (places, weights) = four_nearest(self.resolution, u, v);
        for (place, weight) in places.into_iter().zip(weights) {
            sum.iter_mut().zip(self.vector(place)).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{PI, TAU};

    /// A smooth function of the place, times one basis function.
    fn wave(resolution: usize, cycles: f32) -> Grid {
        let mut grid = Grid { resolution, count: 4, values: Vec::new() };
        for place in 0..resolution * resolution {
            let [u, v] = grid.place(place);
            let value = (PI * v).sin() * (cycles * TAU * u).cos();
            grid.values.extend([0.0, value, 0.0, 0.0]);
        }
        grid
    }

    #[test]
    fn a_constant_collapses_and_a_wave_keeps_what_it_needs() {
        let mean = AbsoluteMean::new(2);
        let flat = Grid { resolution: 32, count: 4, values: [1.0, -2.0, 0.5, 0.0].repeat(32 * 32) };
        assert_eq!(thinned(flat.clone(), 1e-4, &mean).resolution, 1);
        assert_eq!(thinned(flat, 0.0, &mean).resolution, 32);
        let resolutions = [1.0, 4.0].map(|cycles| thinned(wave(64, cycles), 0.01, &mean).resolution);
        assert!(resolutions[0] >= 8 && resolutions[0] < resolutions[1] && resolutions[1] <= 64, "{resolutions:?}");
        assert_eq!(thinned(wave(64, 4.0), 100.0, &mean).resolution, 1);
    }

    /// The mean of |y_1,0| over the sphere is sqrt(3/4π)/2.
    #[test]
    fn the_mean_of_an_absolute_value() {
        let mean = AbsoluteMean::new(4);
        let mut z = vec![0.0; 16];
        z[2] = 1.0;
        let expected = (3.0 / (4.0 * std::f64::consts::PI)).sqrt() * 0.5;
        assert!((mean.difference(&z, &[0.0; 16]) / expected - 1.0).abs() < 0.02);
    }
}
