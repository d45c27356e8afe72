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
/// Sample points per disc, at least and at most.
const POINTS: [usize; 2] = [16, 256];
/// Sample points of all discs in one view, between those ends: each is compared with every disc near its own.
const POINTS_PER_VIEW: usize = 16_384;

/// The share of each sphere in (0, 1]; 1 for a sphere that overlaps no other from anywhere.
///
/// Standard error of a share about 0.01. Invariant under translation and scale; deterministic. Thousands of spheres that all
/// overlap take a second.
pub fn overlap_shares(spheres: &[Sphere]) -> Vec<f32> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let points = (POINTS_PER_VIEW / spheres.len().max(1)).clamp(POINTS[0], POINTS[1]);
    let per_view: Vec<Vec<f64>> = (0..VIEWS)
        .into_par_iter()
        .map(|view| {
            let turn = DVec2::from_angle(TAU * golden * view as f64);
            // A sunflower fills the unit disc evenly, and with y in place of radius² a hemisphere of views.
            let height = (view as f64 + 0.5) / VIEWS as f64;
            let side = turn * (1.0 - height * height).sqrt();
            let toward = DVec3::new(side.x, side.y, height);
            let (right, up) = toward.any_orthonormal_pair();
            let disc = (0..points).map(|i| {
                let angle = TAU * golden * i as f64;
                turn.rotate(DVec2::from_angle(angle)) * ((i as f64 + 0.5) / points as f64).sqrt()
            });
            shares_from(spheres, &DMat3::from_cols(right, up, toward).transpose(), &disc.collect::<Vec<_>>())
        })
        .collect();
    (0..spheres.len()).map(|i| (per_view.iter().map(|shares| shares[i]).sum::<f64>() / VIEWS as f64) as f32).collect()
}

/// Discs near another, from its centre.
#[derive(Default)]
struct Near {
    x: Vec<f32>,
    y: Vec<f32>,
    radius_squared: Vec<f32>,
}

impl Near {
    fn clear(&mut self) {
        [&mut self.x, &mut self.y, &mut self.radius_squared].into_iter().for_each(Vec::clear);
    }

    fn push(&mut self, offset: DVec2, radius: f64) {
        self.x.push(offset.x as f32);
        self.y.push(offset.y as f32);
        self.radius_squared.push((radius * radius) as f32);
    }

    /// Number of discs that cover `point`.
    fn covering(&self, point: DVec2) -> u32 {
        let (x, y) = (point.x as f32, point.y as f32);
        let discs = self.x.iter().zip(&self.y).zip(&self.radius_squared);
        discs.map(|((cx, cy), r2)| u32::from((x - cx) * (x - cx) + (y - cy) * (y - cy) < *r2)).sum()
    }
}

/// The shares of all spheres in one view.
fn shares_from(spheres: &[Sphere], picture_from_object: &DMat3, disc: &[DVec2]) -> Vec<f64> {
    // The largest radius is 1, so that no square is too large or small.
    let scale = 1.0 / spheres.iter().map(|sphere| f64::from(sphere.radius)).fold(f64::MIN_POSITIVE, f64::max);
    let discs: Vec<(DVec2, f64)> = spheres
        .iter()
        .map(|sphere| (sphere.center.as_dvec3() * scale, f64::from(sphere.radius) * scale))
        .map(|(center, radius)| ((*picture_from_object * center).truncate(), radius))
        .collect();
    let mut near = Near::default();
    let share = |(i, &(center, radius)): (usize, &(DVec2, f64))| {
        near.clear();
        for (j, &(other, other_radius)) in discs.iter().enumerate() {
            let offset = other - center;
            if j != i && offset.length_squared() < (radius + other_radius).powi(2) {
                near.push(offset, other_radius);
            }
        }
        disc.iter().map(|&point| 1.0 / f64::from(1 + near.covering(radius * point))).sum::<f64>() / disc.len() as f64
    };
    discs.iter().enumerate().map(share).collect()
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
        let tiny = overlap_shares(&[sphere(0.0, 1.0), sphere(0.2, 1e-12), sphere(0.2, 1e-12), sphere(0.2, 0.0)]);
        assert_eq!((tiny[0], tiny[1], tiny[3]), (1.0, 1.0 / 3.0, 0.25), "{tiny:?}");
    }

    /// Sets of so many that each has the least number of points.
    #[test]
    fn many_in_one_place_share_it() {
        let two = |x: f32| if x < 0.5 { sphere(0.0, 1.0) } else { sphere(3e3, 1.0) };
        let spheres: Vec<Sphere> = (0..2048).map(|i| two((i % 2) as f32)).collect();
        let shares = overlap_shares(&spheres);
        assert!(shares.iter().all(|share| (share * 1024.0 - 1.0).abs() < 1e-3), "{:?}", &shares[..4]);
        let grid: Vec<Sphere> = (0..2048).map(|i| sphere((i % 64) as f32, 0.9)).collect();
        let few: Vec<Sphere> = (0..64).map(|i| sphere(i as f32, 0.9)).collect();
        let [many, few] = [grid, few].map(|spheres| overlap_shares(&spheres));
        for (i, (many, few)) in many.iter().zip(few.iter().cycle()).enumerate() {
            assert!((32.0 * many / few - 1.0).abs() < 0.03, "{i}: {many} {few}");
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
