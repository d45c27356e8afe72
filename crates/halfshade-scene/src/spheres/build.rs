//! From a mesh to its sphere set: normalize, sample, fit, bound, measure.

use super::cover::{grow_to_cover, uncovered_points, violation};
use super::points::{inner_points, surface_points};
use super::polish::{Polish, cover_points, tighten};
use super::solid::Solid;
use super::variational::Target;
use super::{Ball, Sphere, SphereSet};
use crate::cache::CacheKey;
use crate::{Cache, CacheOutcome, Mesh, Progress, Scene, SceneError};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Raise whenever the same mesh and options would give another set.
const VERSION: u32 = 1;
/// Longest edge, as a fraction of the mesh's largest extent, below which an uncovered piece of a triangle is covered by
/// growing a sphere instead of being cut further.
const COVER_TOLERANCE: f64 = 2e-4;
/// Rounds of tightening, each with the points that the one before left uncovered.
const TIGHTEN_ROUNDS: usize = 4;
/// Surface points that the polish covers. With few, spheres shrink between them and must grow back in the end.
const FINE_POINTS: usize = 12_000;
/// Vertices that tightening respects at most; the bound holds for all of them in the end.
const MOST_VERTICES: usize = 40_000;
/// Distance of the lines that measure the result, as a fraction of the largest extent.
const MEASURE_STEP: f64 = 1.0 / 200.0;
/// A mesh whose volume is below this fraction of its largest extent cubed counts as a thin shell.
const THIN: f64 = 1e-6;

/// How a sphere set is fitted. The defaults meet the targets that the crate's tests state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BuildOptions {
    /// Seed of every random choice: the same seed gives the same bits on one thread or many.
    pub seed: u64,
    /// Independent starts, of which the best is kept; at least 1.
    pub restarts: usize,
    /// Attempts per start to leave a local minimum by teleporting a sphere.
    pub teleports: usize,
    /// Whether to lower the outside volume of the union after the sum over spheres; the published method doesn't.
    pub polish: bool,
    /// Attempts per start of the polish to leave a local minimum.
    pub jumps: usize,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { seed: 1, restarts: 4, teleports: 10, polish: true, jumps: 40 }
    }
}

/// A mesh moved into the unit cube about the origin.
struct Normalized {
    corners: Vec<[DVec3; 3]>,
    bounds: [DVec3; 2],
    middle: DVec3,
    extent: f64,
}

impl SphereSet {
    /// Fits `count` spheres that bound `mesh` with little volume outside of it.
    ///
    /// Fewer spheres result only where the mesh is too simple to need them. A mesh that isn't closed is filled where the
    /// lines of three directions agree that it has an inside; one that encloses nothing is covered as a shell. Both
    /// leave a note.
    ///
    /// # Errors
    /// A mesh without triangles, with indices out of range, with positions that are not finite or all in one place; a
    /// count of 0.
    pub fn build(
        mesh: &Mesh,
        count: usize,
        options: &BuildOptions,
        progress: &dyn Progress,
    ) -> Result<Self, SceneError> {
        let mesh = Normalized::new(mesh)?;
        if count == 0 {
            return Err(SceneError::new("a sphere set of 0 spheres bounds nothing").with_remedy("ask for 1 or more"));
        }
        let step = (1.0 / (20.0 * (count as f64).cbrt())).clamp(1.0 / 200.0, 1.0 / 40.0);
        let mut solid = Solid::new(&mesh.corners, 2, step);
        let mut notes = Vec::new();
        let mesh_volume = solid.columns.volume();
        if solid.open_fraction > 0.0 {
            notes.push(format!(
                "the mesh is not closed: {:.1} % of the lines through it enter and leave unequally often; its inside is \
                 what lines of other directions agree on",
                100.0 * solid.open_fraction
            ));
        }
        let thin = mesh_volume < THIN;
        if thin {
            solid = Solid::new(&[], 2, step);
            notes.push(
                "the mesh encloses no volume: its spheres cover it as a thin shell, and the outside volume is given as \
                 a fraction of a ball around the mesh"
                    .into(),
            );
        }
        let area = mesh.corners.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
        let restarts = options.restarts.max(1);
        let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
        let fine = if options.polish { surface_points(&mesh.corners, FINE_POINTS, &mut rng) } else { Vec::new() };
        let steps = 1 + options.teleports + if options.polish { 1 + options.jumps } else { 0 };
        progress.start("fitting spheres", (restarts * steps) as u64);
        let fitted: Vec<(f64, Vec<Ball>)> = (0..restarts as u64)
            .into_par_iter()
            .map(|restart| {
                let mut rng = Pcg64Mcg::seed_from_u64(options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(restart));
                let surface = surface_points(&mesh.corners, (30 * count).clamp(400, 6_000), &mut rng);
                let inner = inner_points(&solid.columns, mesh.bounds, surface.len() / 2);
                let target = Target::new(&solid.columns, [surface, inner].concat());
                let mut balls = target.fit(count, options.teleports, &mut rng, progress);
                if options.polish {
                    let polish = Polish::new(&solid.columns, &fine, area);
                    balls = polish.improve(balls, options.jumps, &mut rng, progress);
                }
                // What counts is the volume after bounding, not before.
                let mut bounded = balls.clone();
                grow_to_cover(&mesh.corners, &mut bounded, 10.0 * COVER_TOLERANCE, |r| r);
                (solid.columns.union_outside(&bounded), balls)
            })
            .collect();
        let mut best =
            fitted.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, balls)| balls).unwrap_or_default();
        if options.polish {
            progress.start("tightening spheres", TIGHTEN_ROUNDS as u64);
            let mut points: Vec<DVec3> = mesh.vertices();
            for round in 0..TIGHTEN_ROUNDS {
                // Triangles reach out between their vertices: where they do, their pieces join the points to be covered.
                if round > 0 {
                    points.extend(uncovered_points(&mesh.corners, &best, 5.0 * COVER_TOLERANCE));
                }
                cover_points(&mut best, &points);
                tighten(&solid.columns, &points, &mut best, 2);
                progress.advance(1);
            }
        }
        progress.start("bounding the triangles", 1);
        let mut set = mesh.bound(best);
        progress.advance(1);
        let estimates: Vec<f64> = (0..3usize)
            .into_par_iter()
            .map(|axis| {
                let corners = if thin { &[] } else { mesh.corners.as_slice() };
                let columns = Solid::new(corners, axis, MEASURE_STEP).columns;
                let whole = if thin { ball_volume(0.5 * mesh.extent()) } else { columns.volume() };
                columns.union_outside(&mesh.normalized(&set.spheres)) / whole
            })
            .collect();
        let (low, high) = estimates.iter().fold((f64::INFINITY, 0.0f64), |(l, h), e| (l.min(*e), h.max(*e)));
        set.outside_volume_fraction = estimates.iter().sum::<f64>() / 3.0;
        set.outside_volume_error = 0.5 * (high - low);
        set.notes = notes;
        Ok(set)
    }

    /// [`SphereSet::build`], or what it once gave for the same mesh, count and options.
    ///
    /// # Errors
    /// Those of [`SphereSet::build`].
    pub fn build_cached(
        mesh: &Mesh,
        count: usize,
        options: &BuildOptions,
        cache: &Cache,
        progress: &dyn Progress,
    ) -> Result<(Self, CacheOutcome), SceneError> {
        let key = CacheKey::new("spheres", VERSION)
            .value(&mesh.positions)
            .value(&mesh.triangles)
            .value(&(count as u64))
            .value(options);
        cache.get_or_compute(&key, || Self::build(mesh, count, options, progress))
    }
}

impl Scene {
    /// Builds the sphere set of every object that blocks, or reads it from the cache; objects with the same mesh and
    /// count share one. Returns what the user should know: notes on caching and on meshes.
    ///
    /// # Errors
    /// Those of [`SphereSet::build`], naming the object.
    pub fn build_spheres(&mut self, cache: &Cache, progress: &dyn Progress) -> Result<Vec<String>, SceneError> {
        let mut notes = Vec::new();
        for k in 0..self.objects.len() {
            let (done, rest) = self.objects.split_at_mut(k);
            let object = &mut rest[0];
            if object.sphere_count == 0 {
                object.spheres = None;
                continue;
            }
            let same = |other: &&crate::Object| {
                other.sphere_count == object.sphere_count
                    && (Arc::ptr_eq(&other.mesh, &object.mesh)
                        || (other.mesh.positions == object.mesh.positions
                            && other.mesh.triangles == object.mesh.triangles))
            };
            if let Some(other) = done.iter().find(same) {
                object.spheres.clone_from(&other.spheres);
                continue;
            }
            let options = BuildOptions::default();
            let (set, outcome) =
                SphereSet::build_cached(&object.mesh, object.sphere_count, &options, cache, progress).map_err(
                    |error| SceneError { problem: format!("object {}: {}", object.name, error.problem), ..error },
                )?;
            notes.extend(outcome.notes.iter().chain(&set.notes).map(|note| format!("object {}: {note}", object.name)));
            object.spheres = Some(Arc::new(set));
        }
        Ok(notes)
    }
}

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

impl Normalized {
    fn new(mesh: &Mesh) -> Result<Self, SceneError> {
        let corner = |index: u32| {
            let position = mesh.positions.get(index as usize).ok_or_else(|| {
                SceneError::new(format!("a triangle uses vertex {index} of {}", mesh.positions.len()))
            })?;
            if position.is_finite() {
                Ok(position.as_dvec3())
            } else {
                Err(SceneError::new(format!("vertex {index} is not finite")))
            }
        };
        let mut corners = Vec::with_capacity(mesh.triangles.len());
        for [a, b, c] in &mesh.triangles {
            corners.push([corner(*a)?, corner(*b)?, corner(*c)?]);
        }
        if corners.is_empty() {
            return Err(SceneError::new("a mesh without triangles has no sphere set"));
        }
        let all = || corners.iter().flatten();
        let (min, max) = (all().copied().reduce(DVec3::min), all().copied().reduce(DVec3::max));
        let (min, max) = (min.unwrap_or_default(), max.unwrap_or_default());
        let (middle, extent) = (min.midpoint(max), (max - min).max_element());
        if extent <= 0.0 {
            return Err(SceneError::new("all vertices of the mesh lie in one place"));
        }
        let normalize = |point: DVec3| (point - middle) / extent;
        let bounds = [normalize(min), normalize(max)];
        for corner in corners.iter_mut().flatten() {
            *corner = normalize(*corner);
        }
        Ok(Self { corners, bounds, middle, extent })
    }

    /// Each vertex once, in a fixed order; every n-th of them if there are very many.
    fn vertices(&self) -> Vec<DVec3> {
        let mut vertices: Vec<DVec3> = self.corners.iter().flatten().copied().collect();
        let key = |p: &DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
        vertices.sort_unstable_by_key(key);
        vertices.dedup_by_key(|p| key(p));
        let stride = vertices.len().div_ceil(MOST_VERTICES);
        vertices.into_iter().step_by(stride.max(1)).collect()
    }

    /// Diagonal of the bounding box, normalized.
    fn extent(&self) -> f64 {
        self.bounds[0].distance(self.bounds[1])
    }

    fn normalized(&self, spheres: &[Sphere]) -> Vec<Ball> {
        spheres
            .iter()
            .map(|s| Ball {
                center: (s.center.as_dvec3() - self.middle) / self.extent,
                radius: f64::from(s.radius) / self.extent,
            })
            .collect()
    }

    /// The spheres in single precision and the mesh's coordinates, grown until they bound the triangles as given.
    fn bound(&self, fitted: Vec<Ball>) -> SphereSet {
        let triangles: Vec<[DVec3; 3]> =
            self.corners.iter().map(|t| t.map(|corner| corner * self.extent + self.middle)).collect();
        let mut balls: Vec<Ball> = fitted
            .iter()
            .filter(|ball| ball.radius > 0.0)
            .map(|ball| Ball {
                center: (ball.center * self.extent + self.middle).as_vec3().as_dvec3(),
                radius: round_up(ball.radius * self.extent),
            })
            .collect();
        let tolerance = COVER_TOLERANCE * self.extent;
        let growth = grow_to_cover(&triangles, &mut balls, tolerance, round_up);
        SphereSet {
            bounding_violation: violation(&triangles, &balls, tolerance),
            growth: growth / (self.extent() * self.extent),
            spheres: balls
                .iter()
                .map(|ball| Sphere { center: ball.center.as_vec3(), radius: ball.radius as f32 })
                .collect(),
            ..SphereSet::default()
        }
    }
}

/// The smallest single-precision number that is at least `x`.
fn round_up(x: f64) -> f64 {
    let rounded = x as f32;
    f64::from(if f64::from(rounded) < x { rounded.next_up() } else { rounded })
}
