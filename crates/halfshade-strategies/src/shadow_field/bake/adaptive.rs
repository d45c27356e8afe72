//! Adaptive sampling [Tamura2006, 4]: fewer points on a shell, and fewer shells, as long as those there were are still
//! known well enough.

use super::{
    basis::Basis,
    grid::{Grid, place},
};
use rayon::prelude::*;

/// The coarsest of the halved grids that still gives every vector of `samples` within `threshold`.
///
/// Every halving is made from the grid before it, and tested against all original samples.
pub(crate) fn thinned<B: Basis>(basis: &B, samples: &Grid<B::Vector>, threshold: f64) -> Grid<B::Vector> {
    let mut best = samples.clone();
    while best.resolution > 1 {
        let half = halved(basis, &best);
        if !all_close(basis, samples, threshold, |place| half.at(basis, place)) {
            break;
        }
        best = half;
    }
    best
}

/// Half the resolution; each new point is the mean of the four old ones around it.
fn halved<B: Basis>(basis: &B, grid: &Grid<B::Vector>) -> Grid<B::Vector> {
    let resolution = grid.resolution / 2;
    let samples =
        (0..resolution * resolution).into_par_iter().map(|number| grid.at(basis, place(resolution, number))).collect();
    Grid { resolution, samples }
}

/// Whether `found` gives every sample within `threshold`.
fn all_close<B: Basis>(
    basis: &B,
    samples: &Grid<B::Vector>,
    threshold: f64,
    found: impl Fn([f32; 2]) -> B::Vector + Sync,
) -> bool {
    (samples.samples.par_iter().enumerate())
        .all(|(number, vector)| basis.difference(&found(place(samples.resolution, number)), vector) < threshold)
}

/// Numbers of the shells to keep, from inside out, so that all samples of those between are still within `threshold`
/// when found between their neighbours, which are `thinned`. The paper names this as future work [Tamura2006, 7].
///
/// From each shell that is kept to the farthest that will do as the next one; the first and the last are always kept.
pub(crate) fn kept_shells<B: Basis>(
    basis: &B,
    (radii, samples): (&[f32], &[Grid<B::Vector>]),
    thinned: &[Grid<B::Vector>],
    threshold: f64,
) -> Vec<usize> {
    let between = |inner: usize, outer: usize, number: usize| {
        let share = (radii[number] - radii[inner]) / (radii[outer] - radii[inner]);
        all_close(basis, &samples[number], threshold, |place| {
            let (a, b) = (thinned[inner].at(basis, place), thinned[outer].at(basis, place));
            basis.mix(&[(&a, 1.0 - share), (&b, share)])
        })
    };
    let mut kept = vec![0];
    let mut inner = 0;
    while inner + 1 < samples.len() {
        let mut outer = inner + 1;
        while outer + 1 < samples.len() && (inner + 1..=outer).all(|number| between(inner, outer + 1, number)) {
            outer += 1;
        }
        kept.push(outer);
        inner = outer;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::{bounds::BoundingSphere, sh::projection::ShBasis};
    use super::*;
    use crate::shared::triangle_rays::TriangleRays;
    use glam::Vec3;
    use std::f32::consts::{PI, TAU};

    /// A smooth function of the place, times one basis function.
    fn wave(resolution: usize, cycles: f32, scale: f32) -> Grid<Vec<f32>> {
        let value = |number| {
            let [u, v] = place(resolution, number);
            vec![0.0, scale * (PI * v).sin() * (cycles * TAU * u).cos(), 0.0, 0.0]
        };
        Grid { resolution, samples: (0..resolution * resolution).map(value).collect() }
    }

    #[test]
    fn a_constant_collapses_and_a_wave_keeps_what_it_needs() {
        let basis = ShBasis::new(2, 8);
        let flat = Grid { resolution: 32, samples: vec![vec![1.0, -2.0, 0.5, 0.0]; 32 * 32] };
        assert_eq!(thinned(&basis, &flat, 1e-4).resolution, 1);
        assert_eq!(thinned(&basis, &flat, 0.0).resolution, 32);
        let resolutions = [1.0, 4.0].map(|cycles| thinned(&basis, &wave(64, cycles, 1.0), 0.01).resolution);
        assert!(resolutions[0] >= 8 && resolutions[0] < resolutions[1] && resolutions[1] <= 64, "{resolutions:?}");
        assert_eq!(thinned(&basis, &wave(64, 4.0, 1.0), 100.0).resolution, 1);
    }

    #[test]
    fn shells_between_which_all_is_linear_are_dropped() {
        let basis = ShBasis::new(2, 8);
        let radii: Vec<f32> = (0..9).map(|i| i as f32).collect();
        // Linear to the fifth shell, then a bend at it.
        let bend = |radius: f32| if radius <= 5.0 { radius } else { 5.0 - 3.0 * (radius - 5.0) };
        let samples: Vec<_> = radii.iter().map(|&radius| wave(8, 1.0, bend(radius))).collect();
        let kept = |threshold| kept_shells(&basis, (&radii, &samples), &samples, threshold);
        assert_eq!(kept(1e-3), [0, 5, 8]);
        assert_eq!(kept(0.0), (0..9).collect::<Vec<_>>());
        assert_eq!(kept(1e3), [0, 8]);
    }

    /// A ball of rays that hides nothing is one point on one shell.
    #[test]
    fn nothing_is_one_point() {
        let basis = ShBasis::new(4, 8);
        let nothing = TriangleRays::new(&halfshade_scene::Mesh::default());
        let bounds = BoundingSphere { center: Vec3::ZERO, radius: 1.0 };
        let grid = Grid { resolution: 4, samples: vec![basis.blocked_from(&nothing, Vec3::X, bounds); 16] };
        assert_eq!(thinned(&basis, &grid, 1e-6).resolution, 1);
    }
}
