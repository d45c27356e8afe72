//! An object occlusion field: shells of sample points, thinned out and stored in few bits.

use super::{
    adaptive::{kept_shells, thinned},
    basis::{Ball, Basis, Storage},
    shell::{Shell, VectorOf},
    shells::{Corners, Grid, direction, place},
    solid::Solid,
};
use crate::shared::triangle_rays::TriangleRays;
use glam::{DVec3, Vec3};
use halfshade_scene::{Mesh, Progress, clusters::bounding_sphere};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use wide::f32x8;

/// What one object hides, around it.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Field<S> {
    /// Of the shells, in the object's space.
    pub(super) center: Vec3,
    /// Of the object's bounding sphere.
    pub(super) radius: f32,
    /// Of the shells, from 0, in radii of the object.
    radii: Vec<f32>,
    shells: Vec<S>,
    /// By distance from the centre in steps of the finest spacing, the next shell outward.
    outer: Vec<u8>,
    /// How the shells lay that there were.
    pub(super) sampled: Shells,
}

/// Where sample points lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Shells {
    pub(super) count: usize,
    /// Shells within the first, each of half the radius of the next: the paper has none.
    pub(super) inner: u32,
    /// Sample points along longitude, as along latitude.
    pub(super) resolution: usize,
    /// Distance between shells, and the radius of the first, in radii of the object's bounding sphere: 0.2 in
    /// [Tamura2006, 6].
    pub(super) spacing: f32,
    /// Whether points within a solid are moved out of it; the paper has them blocked.
    pub(super) leaves_solids: bool,
}

impl Shells {
    /// From the inside, in radii of the object, without the centre.
    pub(super) fn radii(&self) -> Vec<f32> {
        let halved = (1..=self.inner).rev().map(|times| self.spacing * 0.5_f32.powi(times as i32));
        halved.chain((1..=self.count).map(|number| self.spacing * number as f32)).collect()
    }

    /// Distance of which all radii are multiples, in radii of the object.
    fn step(&self) -> f32 {
        self.spacing * 0.5_f32.powi(self.inner as i32)
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.count + self.inner as usize
    }
}

/// A field as it is projected: every shell at the full resolution, in full precision.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Projected<V> {
    center: Vec3,
    radius: f32,
    sampling: Shells,
    radii: Vec<f32>,
    /// The first is the centre: one point.
    shells: Vec<Grid<V>>,
}

/// How a field is thinned out.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Thinning {
    /// Of the error at any original sample point; `None` keeps all of them.
    pub(super) threshold: Option<f64>,
    /// Whether shells may go too.
    pub(super) drops_shells: bool,
}

/// The ball that holds all triangles; `None` if there are none, or they have no extent.
pub(super) fn ball(mesh: &Mesh) -> Option<Ball> {
    let used = mesh.triangles.iter().flatten().map(|&vertex| mesh.positions[vertex as usize].as_dvec3());
    let points: Vec<DVec3> = used.filter(|point| point.is_finite()).collect();
    let (center, radius) = bounding_sphere(&points);
    let ball = Ball { center: center.as_vec3(), radius: radius as f32 };
    (!points.is_empty() && ball.radius > 0.0 && ball.radius.is_finite()).then_some(ball)
}

/// By distance from the centre in steps of the finest spacing, the next of the shells of these `radii` outward.
fn outer_shells(radii: &[f32], sampling: Shells) -> Vec<u8> {
    let steps = (radii.last().unwrap_or(&0.0) / sampling.step()).round() as usize;
    let next = |step: usize| {
        let middle = (step as f32 + 0.5) * sampling.step();
        radii.partition_point(|&radius| radius <= middle) as u8
    };
    (0..steps).map(next).collect()
}

impl<V: Clone + Send + Sync> Projected<V> {
    /// Of a mesh in `ball`.
    pub(super) fn new<B: Basis<Vector = V>>(
        basis: &B,
        (rays, ball): (&TriangleRays, Ball),
        sampling: Shells,
        progress: &dyn Progress,
    ) -> Self {
        let solid = Solid::new(rays, ball);
        let radii: Vec<f32> = std::iter::once(0.0).chain(sampling.radii()).collect();
        let grid = |number: usize| {
            let resolution = if number == 0 { 1 } else { sampling.resolution };
            // As far as the next shell.
            let reach = ball.radius * (radii.get(number + 1).unwrap_or(&radii[number]) - radii[number]);
            let sample = |sample| {
                let point = ball.center + radii[number] * ball.radius * direction(place(resolution, sample));
                match sampling.leaves_solids {
                    true => solid.blocked_near(basis, point, reach),
                    false => basis.blocked_from(rays, point, ball),
                }
            };
            let samples = (0..resolution * resolution).into_par_iter().map(sample).collect();
            progress.advance(u64::from(number > 0));
            Grid { resolution, samples }
        };
        let shells = (0..radii.len()).into_par_iter().map(grid).collect();
        Self { center: ball.center, radius: ball.radius, sampling, radii, shells }
    }
}

impl<V> Projected<V> {
    /// Whether it is sampled so around `ball`, and has all its vectors.
    pub(super) fn is_of(&self, ball: Ball, sampling: Shells, is_vector: impl Fn(&V) -> bool) -> bool {
        let resolution = |number: usize| if number == 0 { 1 } else { sampling.resolution };
        let is_grid = |(number, grid): (usize, &Grid<V>)| {
            grid.resolution == resolution(number) && grid.samples.len() == grid.resolution * grid.resolution
        };
        (Ball { center: self.center, radius: self.radius }, self.sampling) == (ball, sampling)
            && self.radii.iter().copied().eq(std::iter::once(0.0).chain(sampling.radii()))
            && self.shells.len() == self.radii.len()
            && self.shells.iter().enumerate().all(is_grid)
            && self.shells.iter().flat_map(|grid| &grid.samples).all(is_vector)
    }
}

impl<S: Shell> Field<S> {
    /// Whether it is of samples that lie so around `ball`: from the centre to the outermost of their shells.
    pub(super) fn is_of(&self, ball: Ball, sampling: Shells, is_shell: impl Fn(&S) -> bool) -> bool {
        let (radii, outermost) = (sampling.radii(), self.radii.last().copied());
        (Ball { center: self.center, radius: self.radius }, self.sampled) == (ball, sampling)
            && outermost == radii.last().copied()
            && self.radii.first() == Some(&0.0)
            && self.radii.is_sorted_by(|a, b| a < b)
            && self.radii[1..].iter().all(|radius| radii.contains(radius))
            && self.shells.len() == self.radii.len()
            && self.shells.iter().all(|shell| shell.resolution() <= sampling.resolution && is_shell(shell))
            && self.outer == outer_shells(&self.radii, sampling)
    }

    /// Thins a field out and stores it.
    pub(super) fn new(
        basis: &S::Basis,
        projected: &Projected<VectorOf<S>>,
        thinning: Thinning,
        storage: Storage,
    ) -> Self {
        let Projected { center, radius, sampling, radii, shells } = projected;
        let all = || (0..shells.len()).collect();
        let (kept, shells): (Vec<usize>, Vec<S>) = match thinning.threshold {
            Some(threshold) => {
                let grids: Vec<_> = shells.iter().map(|grid| thinned(basis, grid, threshold)).collect();
                let drops = thinning.drops_shells;
                let kept = if drops { kept_shells(basis, (radii, shells), &grids, threshold) } else { all() };
                let stored = kept.iter().map(|&number| S::store(basis, &grids[number], storage)).collect();
                (kept, stored)
            }
            None => (all(), shells.iter().map(|grid| S::store(basis, grid, storage)).collect()),
        };
        let radii: Vec<f32> = kept.iter().map(|&number| radii[number]).collect();
        let outer = outer_shells(&radii, *sampling);
        Self { center: *center, radius: *radius, radii, shells, outer, sampled: *sampling }
    }

    /// Memory that it takes.
    pub(super) fn bytes(&self) -> usize {
        self.shells.iter().map(Shell::bytes).sum()
    }

    /// Of every shell that was sampled, from inside out, the points along longitude that are left; 0: the shell is gone.
    pub(super) fn resolutions(&self) -> Vec<usize> {
        let resolution = |radius: f32| {
            let kept = self.radii.iter().position(|kept| *kept == radius);
            kept.map_or(0, |number| self.shells[number].resolution())
        };
        self.sampled.radii().into_iter().map(resolution).collect()
    }

    /// Adds what is blocked at eight places in shell coordinates, of which as many count as there are sums: distance from
    /// the centre in radii of the object, longitude and latitude as shares of the whole.
    ///
    /// Continuous: the centre is a shell of one point, and past the last shell what is blocked shrinks as the object's
    /// solid angle does.
    #[inline]
    pub(super) fn add_at(&self, [distance, u, v]: [f32x8; 3], sums: &mut [S::Sum]) {
        let outermost = f32x8::splat(self.radii[self.radii.len() - 1]);
        let beyond = distance.simd_ge(outermost);
        // Looked up: a search would take as long as the interpolation.
        let steps = distance.fast_min(outermost) * f32x8::splat(self.sampled.step().recip());
        let last = self.outer.len() - 1;
        let outer = steps.fast_trunc_int().to_array().map(|step| usize::from(self.outer[(step as usize).min(last)]));
        let radius = |inward: usize| f32x8::from(outer.map(|outer| self.radii[outer - inward]));
        let (from, to) = (radius(1), radius(0));
        // Rounding may lead to the shell next to the right one, whose end is the same.
        let share = ((distance - from) / (to - from)).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        let shrunk = outermost / distance;
        let shares = [beyond.select(f32x8::ZERO, f32x8::ONE - share), beyond.select(shrunk * shrunk, share)];
        for (inward, share) in [1, 0].into_iter().zip(shares) {
            let shells = outer.map(|outer| &self.shells[outer - inward]);
            let corners = Corners::new(f32x8::from(shells.map(|shell| shell.resolution() as f32)), u, v);
            for (k, sum) in sums.iter_mut().enumerate() {
                let share = share.as_array()[k];
                if share > 0.0 {
                    shells[k].add(corners.lane(k), share, sum);
                }
            }
        }
    }
}
