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

use super::Ball;
use super::solid::Columns;
use super::variational::{best_ball, most_distant};
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
    /// them by the `balls` as given.
    pub(super) fn improve(
        &self,
        mut balls: Vec<Ball>,
        jumps: usize,
        rng: &mut Pcg64Mcg,
        progress: &dyn Progress,
    ) -> Vec<Ball> {
        let mut best_volume = self.bounded_volume(&balls);
        let mut keep_if_better = |balls: &mut Vec<Ball>, candidate: Vec<Ball>| {
            let volume = self.bounded_volume(&candidate);
            if volume < best_volume {
                (*balls, best_volume) = (candidate, volume);
            }
        };
        // A descent may end higher than it began: its first steps are large, its penalty leaves points to be covered.
        let relaxed = |mut balls: Vec<Ball>, iterations, rate| {
            self.relax(&mut balls, iterations, rate);
            balls
        };
        let candidate = relaxed(balls.clone(), 250, 0.04);
        keep_if_better(&mut balls, candidate);
        progress.advance(1);
        for _ in 0..jumps {
            if let Some(candidate) = self.jump(&balls, rng) {
                keep_if_better(&mut balls, relaxed(candidate, 70, 0.03));
            }
            progress.advance(1);
        }
        let candidate = relaxed(balls.clone(), 150, 0.015);
        keep_if_better(&mut balls, candidate);
        cover_points(&mut balls, self.surface);
        balls
    }

    /// U once the balls have grown to cover the surface points.
    fn bounded_volume(&self, balls: &[Ball]) -> f64 {
        let mut bounded = balls.to_vec();
        cover_points(&mut bounded, self.surface);
        self.solid.union_outside(&bounded)
    }

    /// Gradient descent (Adam) on U plus the penalty; `rate` is the first step as a fraction of the mean radius.
    fn relax(&self, balls: &mut [Ball], iterations: usize, rate: f64) {
        let mean_radius = balls.iter().map(|ball| ball.radius).sum::<f64>() / balls.len().max(1) as f64;
        let (mut first, mut second) = (vec![[0.0; 4]; balls.len()], vec![[0.0f64; 4]; balls.len()]);
        let mut holders = vec![0; self.surface.len()];
        for iteration in 0..iterations {
            let progress = iteration as f64 / iterations as f64;
            let penalty = PENALTY[0] * (PENALTY[1] / PENALTY[0]).powf(progress);
            let step = rate * mean_radius * (1.0 - 0.95 * progress);
            let mut gradient = self.shape_derivative(balls);
            self.add_penalty(balls, penalty, &mut holders, &mut gradient);
            let warm = [0.9f64, 0.99].map(|beta| 1.0 - beta.powi(iteration as i32 + 1));
            for (k, ball) in balls.iter_mut().enumerate() {
                let moves: [f64; 4] = std::array::from_fn(|n| {
                    let g = gradient[k][n];
                    first[k][n] = 0.9 * first[k][n] + 0.1 * g;
                    second[k][n] = 0.99 * second[k][n] + 0.01 * g * g;
                    -step * (first[k][n] / warm[0]) / ((second[k][n] / warm[1]).sqrt() + 1e-9)
                });
                ball.center += DVec3::new(moves[0], moves[1], moves[2]);
                ball.radius = (ball.radius + moves[3]).max(0.02 * mean_radius);
            }
        }
    }

    /// Derivative of U by each ball's centre and radius.
    fn shape_derivative(&self, balls: &[Ball]) -> Vec<[f64; 4]> {
        let mut near = Vec::new();
        balls
            .iter()
            .enumerate()
            .map(|(k, ball)| {
                near.clear();
                near.extend(balls.iter().enumerate().filter(|&(other, b)| {
                    other != k && b.center.distance_squared(ball.center) < (b.radius + ball.radius).powi(2)
                }));
                let mut gradient = DVec3::ZERO;
                let mut exposed = 0.0;
                for direction in &self.directions {
                    let point = ball.center + ball.radius * direction;
                    if let Some(place) = near.iter().position(|(_, other)| other.contains(point)) {
                        // The ball that held the last point probably holds the next.
                        near.swap(0, place);
                    } else if !self.solid.contains(point) {
                        gradient += direction;
                        exposed += 1.0;
                    }
                }
                let weight = 4.0 * std::f64::consts::PI * ball.radius * ball.radius / SHAPE_SAMPLES as f64;
                [weight * gradient.x, weight * gradient.y, weight * gradient.z, weight * exposed]
            })
            .collect()
    }

    /// Adds the derivative of penalty · Σ area · (distance outside every ball)².
    ///
    /// `holders` remembers which ball held each point last, which is nearly always still true.
    fn add_penalty(&self, balls: &[Ball], penalty: f64, holders: &mut [usize], gradient: &mut [[f64; 4]]) {
        for (point, holder) in self.surface.iter().zip(holders) {
            if balls[*holder].contains(*point) {
                continue;
            }
            let (nearest, missing) = least_missing(balls, *point);
            *holder = nearest;
            if missing > 0.0 {
                let pull = -2.0 * penalty * self.area_per_point * missing;
                let toward = pull * (point - balls[nearest].center).normalize_or_zero();
                for (g, p) in gradient[nearest].iter_mut().zip([toward.x, toward.y, toward.z, pull]) {
                    *g += p;
                }
            }
        }
    }

    /// Removes a sphere that is hardly needed and splits one that sticks out far, both drawn from the first few.
    fn jump(&self, balls: &[Ball], rng: &mut Pcg64Mcg) -> Option<Vec<Ball>> {
        let count = balls.len();
        if count < 2 {
            return None;
        }
        let mut owned = vec![Vec::new(); count];
        let mut needed: Vec<f64> = vec![0.0; count];
        for point in self.surface {
            let (nearest, _) = least_missing(balls, *point);
            owned[nearest].push(*point);
            let others = (0..count).filter(|&k| k != nearest).map(|k| missing(&balls[k], *point));
            needed[nearest] += self.area_per_point * others.fold(f64::INFINITY, f64::min).max(0.0);
        }
        let outside: Vec<f64> = (0..count)
            .map(|k| {
                let others = balls.iter().enumerate().filter(|&(other, _)| other != k).map(|(_, ball)| ball);
                self.solid.united_with(others, &balls[k]).outside(&balls[k])
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
        let Ball { center, radius } = balls[split];
        let mut moved = balls.to_vec();
        moved[split] = Ball { center: center.lerp(a, 0.5), radius: 0.6 * radius };
        moved[removed] = Ball { center: center.lerp(b, 0.5), radius: 0.6 * radius };
        Some(moved)
    }
}

/// Fits each ball in turn to the `points` that only it covers, `sweeps` times over. Every point must be covered.
pub(super) fn tighten(solid: &Columns, points: &[DVec3], balls: &mut [Ball], sweeps: usize) {
    let mut covers: Vec<u16> =
        points.iter().map(|p| balls.iter().filter(|ball| ball.contains(*p)).count() as u16).collect();
    for _ in 0..sweeps {
        for k in 0..balls.len() {
            let old = balls[k];
            let own: Vec<DVec3> =
                points.iter().zip(&covers).filter(|&(p, &n)| n == 1 && old.contains(*p)).map(|(p, _)| *p).collect();
            if own.is_empty() {
                continue;
            }
            let region = Ball { radius: 1.4 * old.radius, ..old };
            let others = balls.iter().enumerate().filter(|&(other, _)| other != k).map(|(_, ball)| ball);
            let rest = solid.united_with(others, &region);
            // A hair larger than needed: a point on the rim must count as covered after rounding.
            let loosen = |ball: &Ball| Ball { radius: ball.radius * (1.0 + 1e-12), ..*ball };
            let (fitted, cost) = best_ball(old.center, &own, 0.12, 40, |ball| rest.outside(ball));
            if cost < rest.outside(&old) {
                let new = loosen(&fitted);
                for (p, n) in points.iter().zip(&mut covers) {
                    *n = *n + u16::from(new.contains(*p)) - u16::from(old.contains(*p));
                }
                balls[k] = new;
            }
        }
    }
}

/// Grows balls until each point is in one, the farthest points first.
pub(super) fn cover_points(balls: &mut [Ball], points: &[DVec3]) {
    let mut open: Vec<(f64, DVec3)> =
        points.iter().map(|p| (least_missing(balls, *p).1, *p)).filter(|(missing, _)| *missing > 0.0).collect();
    open.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, point) in open {
        let (nearest, missing) = least_missing(balls, point);
        if missing > 0.0 {
            balls[nearest].radius += missing + 1e-12;
        }
    }
}

fn missing(ball: &Ball, point: DVec3) -> f64 {
    ball.center.distance(point) - ball.radius
}

/// The ball that holds the point deepest, or needs to grow least to hold it, and by how much.
fn least_missing(balls: &[Ball], point: DVec3) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (k, ball) in balls.iter().enumerate() {
        let missing = missing(ball, point);
        if missing < best.1 {
            best = (k, missing);
        }
    }
    best
}
