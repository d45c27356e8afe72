//! Lowers the outside volume of the *union*, which is what a shadow shows, where \[Wang2006\] lowers a sum over spheres.
//!
//! Not part of the published method. Three moves, each on U = volume of (union of the spheres) minus the mesh:
//! - **relax**: descent along the exact shape derivative. Moving a sphere's surface outwards by δ over an area dA that
//!   neither the mesh nor another sphere holds changes U by δ dA; every surface point of the mesh that sticks out of all
//!   spheres pulls the nearest one by a quadratic penalty. All spheres move at once, so that borders between them find
//!   their places.
//! - **jump**: teleportation as in the published method, but on U, and followed by a relaxation of all spheres.
//! - **tighten**: each sphere in turn is fitted by BOBYQA to the points that only it covers, with the mesh and the
//!   other spheres taken as one solid. Never raises U.

use super::DSphere;
use super::solid::Columns;
use super::variational::{best_sphere, most_distant};
use crate::Progress;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Points per sphere at which the shape derivative is sampled.
const SHAPE_SAMPLES: usize = 128;
/// Penalty per area and squared distance, at the start and at the end of a relaxation: in equilibrium surface points
/// stick out by about 5 / penalty of the mesh's extent.
const PENALTY: [f64; 2] = [400.0, 6_000.0];

/// The mesh as the polish sees it.
pub(super) struct Polish<'a> {
    /// The inside of the mesh.
    solid: &'a Columns,
    /// Evenly spread points of the surface.
    surface: &'a [DVec3],
    /// Surface area that each of them stands for.
    area_per_point: f64,
    directions: Vec<DVec3>,
}

impl<'a> Polish<'a> {
    pub(super) fn new(solid: &'a Columns, surface: &'a [DVec3], area: f64) -> Self {
        // Fibonacci lattice: even on the sphere.
        let directions = (0..SHAPE_SAMPLES)
            .map(|k| {
                let z = 1.0 - (2.0 * k as f64 + 1.0) / SHAPE_SAMPLES as f64;
                let (sin, cos) = (k as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt())).sin_cos();
                let across = (1.0 - z * z).sqrt();
                DVec3::new(across * cos, across * sin, z)
            })
            .collect();
        Self { solid, surface, area_per_point: area / surface.len().max(1) as f64, directions }
    }

    /// Relaxes, then tries `jumps` teleportations. Covers the surface points on return, with no larger U than covering
    /// them by the `spheres` as given.
    pub(super) fn improve(
        &self,
        mut spheres: Vec<DSphere>,
        jumps: usize,
        rng: &mut Pcg64Mcg,
        progress: &dyn Progress,
    ) -> Vec<DSphere> {
        let mut best_volume = self.bounded_volume(&spheres);
        let mut keep_if_better = |spheres: &mut Vec<DSphere>, candidate: Vec<DSphere>| {
            let volume = self.bounded_volume(&candidate);
            if volume < best_volume {
                (*spheres, best_volume) = (candidate, volume);
            }
        };
        // A descent may end higher than it began: its first steps are large, its penalty leaves points to be covered.
        let relaxed = |mut spheres: Vec<DSphere>, iterations, rate| {
            self.relax(&mut spheres, iterations, rate);
            spheres
        };
        let candidate = relaxed(spheres.clone(), 250, 0.04);
        keep_if_better(&mut spheres, candidate);
        progress.advance(1);
        for _ in 0..jumps {
            if let Some(candidate) = self.jump(&spheres, rng) {
                keep_if_better(&mut spheres, relaxed(candidate, 70, 0.03));
            }
            progress.advance(1);
        }
        let candidate = relaxed(spheres.clone(), 150, 0.015);
        keep_if_better(&mut spheres, candidate);
        cover_points(&mut spheres, self.surface);
        spheres
    }

    /// U once the spheres have grown to cover the surface points.
    fn bounded_volume(&self, spheres: &[DSphere]) -> f64 {
        let mut bounded = spheres.to_vec();
        cover_points(&mut bounded, self.surface);
        self.solid.union_outside(&bounded)
    }

    /// Gradient descent (Adam) on U plus the penalty; `rate` is the first step as a fraction of the mean radius.
    fn relax(&self, spheres: &mut [DSphere], iterations: usize, rate: f64) {
        let mean_radius = spheres.iter().map(|sphere| sphere.radius).sum::<f64>() / spheres.len().max(1) as f64;
        let (mut first, mut second) = (vec![[0.0; 4]; spheres.len()], vec![[0.0f64; 4]; spheres.len()]);
        let mut holders = vec![0; self.surface.len()];
        for iteration in 0..iterations {
            let progress = iteration as f64 / iterations as f64;
            let penalty = PENALTY[0] * (PENALTY[1] / PENALTY[0]).powf(progress);
            let step = rate * mean_radius * (1.0 - 0.95 * progress);
            let mut gradient = self.shape_derivative(spheres);
            self.add_penalty(spheres, penalty, &mut holders, &mut gradient);
            let warm = [0.9f64, 0.99].map(|beta| 1.0 - beta.powi(iteration as i32 + 1));
            for (k, sphere) in spheres.iter_mut().enumerate() {
                let moves: [f64; 4] = std::array::from_fn(|n| {
                    let g = gradient[k][n];
                    first[k][n] = 0.9 * first[k][n] + 0.1 * g;
                    second[k][n] = 0.99 * second[k][n] + 0.01 * g * g;
                    -step * (first[k][n] / warm[0]) / ((second[k][n] / warm[1]).sqrt() + 1e-9)
                });
                sphere.center += DVec3::new(moves[0], moves[1], moves[2]);
                sphere.radius = (sphere.radius + moves[3]).max(0.02 * mean_radius);
            }
        }
    }

    /// Derivative of U by each sphere's centre and radius.
    fn shape_derivative(&self, spheres: &[DSphere]) -> Vec<[f64; 4]> {
        let mut near = Vec::new();
        spheres
            .iter()
            .enumerate()
            .map(|(k, sphere)| {
                near.clear();
                near.extend(spheres.iter().enumerate().filter(|&(other, b)| {
                    other != k && b.center.distance_squared(sphere.center) < (b.radius + sphere.radius).powi(2)
                }));
                let mut gradient = DVec3::ZERO;
                let mut exposed = 0.0;
                for direction in &self.directions {
                    let point = sphere.center + sphere.radius * direction;
                    if let Some(place) = near.iter().position(|(_, other)| other.contains(point)) {
                        // The sphere that held the last point probably holds the next.
                        near.swap(0, place);
                    } else if !self.solid.contains(point) {
                        gradient += direction;
                        exposed += 1.0;
                    }
                }
                let weight = 4.0 * std::f64::consts::PI * sphere.radius * sphere.radius / SHAPE_SAMPLES as f64;
                [weight * gradient.x, weight * gradient.y, weight * gradient.z, weight * exposed]
            })
            .collect()
    }

    /// Adds the derivative of penalty · Σ area · (distance outside every sphere)².
    ///
    /// `holders` remembers which sphere held each point last, which is nearly always still true.
    fn add_penalty(&self, spheres: &[DSphere], penalty: f64, holders: &mut [usize], gradient: &mut [[f64; 4]]) {
        for (point, holder) in self.surface.iter().zip(holders) {
            if spheres[*holder].contains(*point) {
                continue;
            }
            let (nearest, missing) = least_missing(spheres, *point);
            *holder = nearest;
            if missing > 0.0 {
                let pull = -2.0 * penalty * self.area_per_point * missing;
                let toward = pull * (point - spheres[nearest].center).normalize_or_zero();
                for (g, p) in gradient[nearest].iter_mut().zip([toward.x, toward.y, toward.z, pull]) {
                    *g += p;
                }
            }
        }
    }

    /// Removes a sphere that is hardly needed and splits one that sticks out far, both drawn from the first few.
    fn jump(&self, spheres: &[DSphere], rng: &mut Pcg64Mcg) -> Option<Vec<DSphere>> {
        let count = spheres.len();
        if count < 2 {
            return None;
        }
        let mut owned = vec![Vec::new(); count];
        let mut needed: Vec<f64> = vec![0.0; count];
        for point in self.surface {
            let (nearest, _) = least_missing(spheres, *point);
            owned[nearest].push(*point);
            let others = (0..count).filter(|&k| k != nearest).map(|k| missing(&spheres[k], *point));
            needed[nearest] += self.area_per_point * others.fold(f64::INFINITY, f64::min).max(0.0);
        }
        let outside: Vec<f64> = (0..count)
            .map(|k| {
                let others = spheres.iter().enumerate().filter(|&(other, _)| other != k).map(|(_, sphere)| sphere);
                self.solid.united_with(others, &spheres[k]).outside(&spheres[k])
            })
            .collect();
        let mut draw = || (rng.random::<f64>().powi(2) * 8f64.min(count as f64 - 1.0)) as usize;
        let (split_rank, removed_rank) = (draw(), draw());
        let mut by_outside: Vec<usize> = (0..count).filter(|&k| owned[k].len() > 1).collect();
        by_outside.sort_by(|&a, &b| outside[b].total_cmp(&outside[a]));
        let split = *by_outside.get(split_rank)?;
        let mut by_need: Vec<usize> = (0..count).filter(|&k| k != split).collect();
        by_need.sort_by(|&a, &b| (needed[a] - outside[a]).total_cmp(&(needed[b] - outside[b])));
        let removed = *by_need.get(removed_rank)?;
        let (a, b) = most_distant(&owned[split]);
        let DSphere { center, radius } = spheres[split];
        let mut moved = spheres.to_vec();
        moved[split] = DSphere { center: center.lerp(a, 0.5), radius: 0.6 * radius };
        moved[removed] = DSphere { center: center.lerp(b, 0.5), radius: 0.6 * radius };
        Some(moved)
    }
}

/// Fits each sphere in turn to the `points` that only it covers, `sweeps` times over. Every point must be covered.
pub(super) fn tighten(solid: &Columns, points: &[DVec3], spheres: &mut [DSphere], sweeps: usize) {
    let mut covers: Vec<u16> =
        points.iter().map(|p| spheres.iter().filter(|sphere| sphere.contains(*p)).count() as u16).collect();
    for _ in 0..sweeps {
        for k in 0..spheres.len() {
            let old = spheres[k];
            let own: Vec<DVec3> =
                points.iter().zip(&covers).filter(|&(p, &n)| n == 1 && old.contains(*p)).map(|(p, _)| *p).collect();
            if own.is_empty() {
                continue;
            }
            let region = DSphere { radius: 1.4 * old.radius, ..old };
            let others = spheres.iter().enumerate().filter(|&(other, _)| other != k).map(|(_, sphere)| sphere);
            let rest = solid.united_with(others, &region);
            // A hair larger than needed: a point on the rim must count as covered after rounding.
            let loosen = |sphere: &DSphere| DSphere { radius: sphere.radius * (1.0 + 1e-12), ..*sphere };
            let (fitted, cost) = best_sphere(old.center, &own, 0.12, 40, |sphere| rest.outside(sphere));
            if cost < rest.outside(&old) {
                let new = loosen(&fitted);
                for (p, n) in points.iter().zip(&mut covers) {
                    *n = *n + u16::from(new.contains(*p)) - u16::from(old.contains(*p));
                }
                spheres[k] = new;
            }
        }
    }
}

/// Grows spheres until each point is in one, the farthest points first.
pub(super) fn cover_points(spheres: &mut [DSphere], points: &[DVec3]) {
    let mut open: Vec<(f64, DVec3)> =
        points.iter().map(|p| (least_missing(spheres, *p).1, *p)).filter(|(missing, _)| *missing > 0.0).collect();
    open.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, point) in open {
        let (nearest, missing) = least_missing(spheres, point);
        if missing > 0.0 {
            spheres[nearest].radius += missing + 1e-12;
        }
    }
}

fn missing(sphere: &DSphere, point: DVec3) -> f64 {
    sphere.center.distance(point) - sphere.radius
}

/// The sphere that holds the point deepest, or needs to grow least to hold it, and by how much.
fn least_missing(spheres: &[DSphere], point: DVec3) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (k, sphere) in spheres.iter().enumerate() {
        let missing = missing(sphere, point);
        if missing < best.1 {
            best = (k, missing);
        }
    }
    best
}
