//! Variational sphere sets: a Lloyd iteration on outside volume ([Guerrero2007, 4.1] after \[Wang2006\]).
//!
//! E = sum over spheres of the volume inside the sphere and outside the object [Guerrero2007, eq. 4.1]. Each round
//! assigns every surface and inner point to one sphere in flood-fill order, always by the least growth of E, then moves
//! each centre to the least outside volume of the sphere that covers its points. When a round no longer improves E, a
//! sphere is teleported: the one that overlaps the others most is removed, the one with the largest outside volume is
//! split at the two most distant of its points; kept if E improves.

use super::DSphere;
use super::points::{covering_radius, farthest_points, mean_centered_sphere, neighbor_graph};
use super::solid::Columns;
use crate::Progress;
use bobyqa::{Bobyqa, Config};
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A round must lower E by this fraction to be followed by another.
const WORTHWHILE: f64 = 2e-3;
const ROUNDS: usize = 25;
/// Radii at which a centre's outside volume is tabulated for the flood fill.
const PROFILE: usize = 24;

/// The shape to which spheres are fitted.
pub(super) struct Target<'a> {
    /// The inside of the mesh.
    pub(super) solid: &'a Columns,
    /// Surface points, then inner points.
    pub(super) points: Vec<DVec3>,
    /// Neighbours of each point.
    graph: Vec<Vec<u32>>,
}

/// A set in the making: spheres and the points that each must cover.
#[derive(Clone)]
struct Fit {
    spheres: Vec<DSphere>,
    owned: Vec<Vec<u32>>,
    outside: Vec<f64>,
}

impl<'a> Target<'a> {
    pub(super) fn new(solid: &'a Columns, points: Vec<DVec3>) -> Self {
        let graph = neighbor_graph(&points, 8);
        Self { solid, points, graph }
    }

    /// `count` spheres by the method of the module; `teleports` attempts to leave local minima.
    pub(super) fn fit(
        &self,
        count: usize,
        teleports: usize,
        rng: &mut Pcg64Mcg,
        progress: &dyn Progress,
    ) -> Vec<DSphere> {
        let mut best = self.settle(self.first_centers(count, rng));
        progress.advance(1);
        let mut refused = 0;
        for _ in 0..teleports {
            // After a refusal the runners-up are tried: the same pair again would be refused again.
            let Some(centers) = self.teleport(&best, refused) else { break };
            let candidate = self.settle(centers);
            progress.advance(1);
            if candidate.total() < best.total() * (1.0 - 1e-4) {
                (best, refused) = (candidate, 0);
            } else {
                refused += 1;
            }
        }
        best.spheres
    }

    /// Random start by farthest points among a random part of all points, which spreads better than plain drawing.
    fn first_centers(&self, count: usize, rng: &mut Pcg64Mcg) -> Vec<DVec3> {
        let drawn = (4 * count).min(self.points.len()).max(1);
        let pool: Vec<DVec3> = (0..drawn).map(|_| self.points[rng.random_range(0..self.points.len())]).collect();
        let mut centers = farthest_points(&pool, count);
        for _ in 0..3 {
            centers = self.means(&centers);
        }
        centers
    }

    /// One step of k-means.
    fn means(&self, centers: &[DVec3]) -> Vec<DVec3> {
        let mut sums = vec![(DVec3::ZERO, 0.0); centers.len()];
        for point in &self.points {
            let nearest = (0..centers.len())
                .min_by(|&a, &b| centers[a].distance_squared(*point).total_cmp(&centers[b].distance_squared(*point)))
                .unwrap_or(0);
            sums[nearest].0 += point;
            sums[nearest].1 += 1.0;
        }
        sums.iter().zip(centers).map(|((sum, n), old)| if *n > 0.0 { sum / n } else { *old }).collect()
    }

    /// Rounds of assignment and optimization until E no longer improves.
    fn settle(&self, mut centers: Vec<DVec3>) -> Fit {
        let mut best: Option<Fit> = None;
        for _ in 0..ROUNDS {
            let fit = self.optimize(&centers, self.assign(&centers));
            centers.clear();
            centers.extend(fit.spheres.iter().map(|sphere| sphere.center));
            let before = best.as_ref().map_or(f64::INFINITY, Fit::total);
            let improved = fit.total() < before * (1.0 - WORTHWHILE);
            if fit.total() < before {
                best = Some(fit);
            }
            if !improved {
                break;
            }
        }
        best.unwrap_or_else(|| self.optimize(&centers, self.assign(&centers)))
    }

    /// Flood-fill assignment: every point to the sphere whose outside volume grows least by covering it.
    fn assign(&self, centers: &[DVec3]) -> Vec<Vec<u32>> {
        let reach = mean_centered_sphere(&self.points).radius;
        let profiles: Vec<Profile> = centers
            .par_iter()
            .map(|&center| Profile::new(self.solid, center, reach / (centers.len() as f64).cbrt()))
            .collect();
        let mut radius = vec![0.0f64; centers.len()];
        let mut owner: Vec<Option<u32>> = vec![None; self.points.len()];
        let mut queue = BinaryHeap::new();
        let growth = |sphere: usize, radius: f64, point: u32| {
            let distance = self.points[point as usize].distance(centers[sphere]);
            let profile = &profiles[sphere];
            // The distance itself breaks ties among points that cost nothing, so that the fill spreads from the centre.
            (profile.at(radius.max(distance)) - profile.at(radius)).max(0.0) + 1e-9 * distance
        };
        for (sphere, center) in centers.iter().enumerate() {
            let nearest = (0..self.points.len()).min_by(|&a, &b| {
                self.points[a].distance_squared(*center).total_cmp(&self.points[b].distance_squared(*center))
            });
            if let Some(nearest) = nearest {
                queue.push(Reverse((Cost(growth(sphere, 0.0, nearest as u32)), sphere as u32, nearest as u32)));
            }
        }
        let mut left = self.points.len();
        let mut next_unowned = 0;
        while left > 0 {
            let Some(Reverse((Cost(cost), sphere, point))) = queue.pop() else {
                // Another component of the graph: its first point goes where it costs least, the fill goes on from it.
                while owner[next_unowned].is_some() {
                    next_unowned += 1;
                }
                let point = next_unowned as u32;
                let cheapest = (0..centers.len())
                    .min_by(|&a, &b| growth(a, radius[a], point).total_cmp(&growth(b, radius[b], point)))
                    .unwrap_or(0);
                queue.push(Reverse((Cost(0.0), cheapest as u32, point)));
                continue;
            };
            if owner[point as usize].is_some() {
                continue;
            }
            let now = growth(sphere as usize, radius[sphere as usize], point);
            // The sphere has grown since: the price has fallen. It only matters if another offer is now dearer.
            if now < cost * (1.0 - 1e-12) && queue.peek().is_some_and(|Reverse((Cost(other), ..))| *other < now) {
                queue.push(Reverse((Cost(now), sphere, point)));
                continue;
            }
            owner[point as usize] = Some(sphere);
            left -= 1;
            let r = &mut radius[sphere as usize];
            *r = r.max(self.points[point as usize].distance(centers[sphere as usize]));
            for &other in &self.graph[point as usize] {
                if owner[other as usize].is_none() {
                    queue.push(Reverse((Cost(growth(sphere as usize, *r, other)), sphere, other)));
                }
            }
        }
        let mut owned = vec![Vec::new(); centers.len()];
        for (point, sphere) in owner.iter().enumerate() {
            if let Some(sphere) = sphere {
                owned[*sphere as usize].push(point as u32);
            }
        }
        owned
    }

    /// Moves each centre to the least outside volume of the sphere that covers its points.
    fn optimize(&self, centers: &[DVec3], owned: Vec<Vec<u32>>) -> Fit {
        let fitted: Vec<(DSphere, f64)> = centers
            .par_iter()
            .zip(&owned)
            .map(|(&center, owned)| {
                let points: Vec<DVec3> = owned.iter().map(|&k| self.points[k as usize]).collect();
                best_sphere(center, &points, 0.3, 45, |sphere| self.solid.outside(sphere))
            })
            .collect();
        let (spheres, outside) = fitted.into_iter().unzip();
        Fit { spheres, owned, outside }
    }

    /// Centres after removing the sphere that overlaps the others most and splitting the one with the `rank`-th
    /// largest outside volume. `None` when there is nothing left to try.
    fn teleport(&self, fit: &Fit, rank: usize) -> Option<Vec<DVec3>> {
        let count = fit.spheres.len();
        let mut largest: Vec<usize> = (0..count).filter(|&k| fit.owned[k].len() > 1).collect();
        largest.sort_by(|&a, &b| fit.outside[b].total_cmp(&fit.outside[a]));
        let split = *largest.get(rank)?;
        let overlap = |k: usize| {
            if fit.owned[k].is_empty() {
                return f64::INFINITY;
            }
            let points = fit.owned[k].iter().map(|&p| self.points[p as usize]);
            let shared =
                points.filter(|p| (0..count).any(|other| other != k && fit.spheres[other].contains(*p))).count();
            shared as f64 / fit.owned[k].len() as f64
        };
        let removed = (0..count).filter(|&k| k != split).max_by(|&a, &b| overlap(a).total_cmp(&overlap(b)))?;
        let points: Vec<DVec3> = fit.owned[split].iter().map(|&p| self.points[p as usize]).collect();
        let (a, b) = most_distant(&points);
        let mut centers: Vec<DVec3> = fit.spheres.iter().map(|sphere| sphere.center).collect();
        (centers[split], centers[removed]) = (a, b);
        Some(centers)
    }
}

impl Fit {
    fn total(&self) -> f64 {
        self.outside.iter().sum()
    }
}

/// The two most distant points, approximately: the farthest from the first, and the farthest from that.
pub(super) fn most_distant(points: &[DVec3]) -> (DVec3, DVec3) {
    let farthest = |from: DVec3| {
        let farther = |a: &&DVec3, b: &&DVec3| a.distance_squared(from).total_cmp(&b.distance_squared(from));
        points.iter().max_by(farther).copied().unwrap_or(from)
    };
    let a = farthest(points.first().copied().unwrap_or_default());
    (a, farthest(a))
}

/// The sphere that covers `points` at the least `cost`, its centre found by BOBYQA from `center` in at most `evaluations`
/// steps, at most `reach` of its first radius away. Returns it and its cost.
pub(super) fn best_sphere(
    center: DVec3,
    points: &[DVec3],
    reach: f64,
    evaluations: usize,
    cost: impl Fn(&DSphere) -> f64,
) -> (DSphere, f64) {
    let sphere_at = |center: DVec3| DSphere { center, radius: covering_radius(center, points.iter()) };
    let start = sphere_at(center);
    let start_cost = cost(&start);
    let reach = reach * start.radius;
    if points.is_empty() || reach <= 1e-9 {
        return (start, start_cost);
    }
    let mut config = Config::new(3);
    config.rho_begin = 0.3 * reach;
    config.rho_end = 1e-3 * reach;
    config.max_fun = evaluations;
    let mut x = center.to_array();
    let (lower, upper) = (x.map(|c| c - reach), x.map(|c| c + reach));
    let Ok(mut solver) = Bobyqa::new(3, config) else { return (start, start_cost) };
    let outcome = solver.minimize(|x| cost(&sphere_at(DVec3::new(x[0], x[1], x[2]))), &mut x, &lower, &upper);
    if outcome.f < start_cost { (sphere_at(DVec3::from(x)), outcome.f) } else { (start, start_cost) }
}

/// Outside volume of spheres about one centre as a function of the radius.
struct Profile {
    step: f64,
    volumes: Vec<f64>,
    slope: f64,
}

impl Profile {
    /// Tabulated up to `reach`; beyond, the cube of the radius goes on.
    fn new(solid: &Columns, center: DVec3, reach: f64) -> Self {
        let step = 2.0 * reach / PROFILE as f64;
        let volumes: Vec<f64> =
            (0..=PROFILE).map(|k| solid.outside(&DSphere { center, radius: k as f64 * step })).collect();
        Self { step, slope: 4.0 / 3.0 * std::f64::consts::PI, volumes }
    }

    fn at(&self, radius: f64) -> f64 {
        let x = radius / self.step;
        let k = x as usize;
        if k < PROFILE {
            self.volumes[k] + (x - k as f64) * (self.volumes[k + 1] - self.volumes[k])
        } else {
            let end = PROFILE as f64 * self.step;
            self.volumes[PROFILE] + self.slope * (radius.powi(3) - end.powi(3))
        }
    }
}

/// A cost that orders; costs are finite.
#[derive(PartialEq, Clone, Copy)]
struct Cost(f64);

impl Eq for Cost {}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
