//! Share of a sphere's silhouette that is its own: overlapping spheres block the same directions twice.
//!
//! Summing log visibilities [Guerrero2007, eq. 4.7] assumes that blockers are independent. The spheres of one object are
//! not: where k of them overlap as seen from a receiver, the same direction is blocked k times, and the truncated
//! exponential of so large a sum loses all accuracy. With an orthographic view along ω, let k(x) be the number of
//! spheres that cover the point x of the picture plane. The share of sphere i is
//!
//! ```text
//! w_i = mean over ω of  1/(π r_i²) ∫ over disc i of 1/k(x) dx
//! ```
//!
//! so that the shared discs tile the silhouette of the union: Σ_i w_i π r_i² is its area, averaged over all views (a
//! quarter of the surface area for a convex union, by Cauchy's formula). Scaling each sphere's log by w_i counts a
//! direction about once. A far view is assumed: spheres that a nearby receiver's tangent plane removes still share.

use super::Sphere;
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Views averaged over; they come in pairs of opposite directions of which one suffices.
const VIEWS: usize = 48;
/// Sample points per disc.
const POINTS: usize = 256;

/// The share of each sphere in (0, 1]; 1 for a sphere that overlaps no other from anywhere.
///
/// Standard error of a share about 0.01. Invariant under translation and scale; deterministic.
pub fn overlap_shares(spheres: &[Sphere]) -> Vec<f32> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    // A sunflower fills the unit disc evenly, and with y in place of radius² a hemisphere of views.
    let disc: Vec<DVec2> = (0..POINTS)
        .map(|i| DVec2::from_angle(TAU * golden * i as f64) * ((i as f64 + 0.5) / POINTS as f64).sqrt())
        .collect();
    let views: Vec<DMat3> = (0..VIEWS)
        .map(|i| {
            let height = (i as f64 + 0.5) / VIEWS as f64;
            let side = DVec2::from_angle(TAU * golden * i as f64) * (1.0 - height * height).sqrt();
            let view = DVec3::new(side.x, side.y, height);
            let (right, up) = view.any_orthonormal_pair();
            DMat3::from_cols(right, up, view).transpose()
        })
        .collect();
    let per_view: Vec<Vec<f64>> = views.par_iter().map(|view| shares_from(spheres, view, &disc)).collect();
    (0..spheres.len()).map(|i| (per_view.iter().map(|shares| shares[i]).sum::<f64>() / VIEWS as f64) as f32).collect()
}

/// The shares of all spheres in one view.
fn shares_from(spheres: &[Sphere], picture_from_object: &DMat3, disc: &[DVec2]) -> Vec<f64> {
    let discs: Vec<(DVec2, f64)> = spheres
        .iter()
        .map(|sphere| ((*picture_from_object * sphere.center.as_dvec3()).truncate(), f64::from(sphere.radius)))
        .collect();
    let mut near = Vec::new();
    discs
        .iter()
        .enumerate()
        .map(|(i, &(center, radius))| {
            near.clear();
            near.extend(discs.iter().enumerate().filter_map(|(j, &(other, other_radius))| {
                let offset = other - center;
                (j != i && offset.length_squared() < (radius + other_radius).powi(2)).then_some((offset, other_radius))
            }));
            let shared: f64 = disc
                .iter()
                .map(|&point| {
                    let covers = |&&(offset, r): &&(DVec2, f64)| (radius * point - offset).length_squared() < r * r;
                    1.0 / (1 + near.iter().filter(covers).count()) as f64
                })
                .sum();
            shared / disc.len() as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::f64::consts::PI;

    /// Mean area of the union's silhouette as the shares tell it: Σ w_i π r_i².
    fn mean_silhouette_area(spheres: &[Sphere], shares: &[f32]) -> f64 {
        spheres.iter().zip(shares).map(|(s, &w)| f64::from(w) * PI * f64::from(s.radius).powi(2)).sum()
    }

    fn sphere(x: f32, radius: f32) -> Sphere {
        Sphere { center: Vec3::new(x, 0.0, 0.0), radius }
    }

    #[test]
    fn alone_a_sphere_owns_all_of_itself_and_a_copy_half() {
        assert_eq!(overlap_shares(&[sphere(3.0, 0.5)]), [1.0]);
        assert_eq!(overlap_shares(&[sphere(3.0, 0.5); 4]), [0.25; 4]);
        assert!(overlap_shares(&[]).is_empty());
    }

    /// A small sphere inside a large one owns half of itself; the large one loses half of the small one's disc.
    #[test]
    fn a_sphere_inside_another() {
        let shares = overlap_shares(&[sphere(0.0, 1.0), sphere(0.2, 0.5)]);
        assert_eq!(shares[1], 0.5);
        assert!((shares[0] - (1.0 - 0.5 * 0.25)).abs() < 0.01, "{shares:?}");
    }

    /// Two far spheres hide each other only from the few directions near their axis: the fraction of views at an angle
    /// below asin(2r/D) is r²·2/D², and what overlaps there is small too.
    #[test]
    fn far_spheres_hardly_share_and_scale_changes_nothing() {
        let far = overlap_shares(&[sphere(0.0, 1.0), sphere(40.0, 1.0)]);
        assert!(far.iter().all(|&share| share > 0.98), "{far:?}");
        let near = overlap_shares(&[sphere(0.0, 1.0), sphere(1.0, 0.7)]);
        let scaled = overlap_shares(&[sphere(0.0, 1e-3), sphere(1e-3, 0.7e-3)]);
        for (a, b) in near.iter().zip(scaled) {
            assert!((a - b).abs() < 0.01);
        }
    }

    /// Against Cauchy: two equal spheres of radius 1 at distance 1. The union's mean silhouette by brute force on the
    /// lens: π per disc minus the overlap of two unit discs at distance sin φ, averaged over views.
    #[test]
    fn shares_tile_the_silhouette_of_the_union() {
        let spheres = [sphere(0.0, 1.0), sphere(1.0, 1.0)];
        let shares = overlap_shares(&spheres);
        let steps = 4000u32;
        let lens = |d: f64| 2.0 * (d / 2.0).acos() - d / 2.0 * (4.0 - d * d).sqrt();
        let mean: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
            .map(|cosine| 2.0 * PI - lens((1.0 - cosine * cosine).sqrt()))
            .sum::<f64>()
            / f64::from(steps);
        assert!((mean_silhouette_area(&spheres, &shares) / mean - 1.0).abs() < 0.01);
    }
}
