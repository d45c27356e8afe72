//! Sphere sets of meshes: normalize, sample, fit, bound, measure.

use super::cover::{grow_to_cover, uncovered_points};
use super::normalized::{COVER_TOLERANCE, NormalizedMesh};
use super::points::{inner_points, surface_points};
use super::polish::{Polish, cover_points, tighten};
use super::solid::Solid;
use super::variational::Target;
use super::{DSphere, Sphere, SphereFit, SphereSet, shadow};
use crate::cache::CacheKey;
use crate::{Cache, CacheOutcome, Mesh, Progress, SceneError};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::Serialize;

/// Raise whenever the same mesh and options would give another set.
const VERSION: u32 = 7;
/// Surface points to which spheres are fitted, at most.
const SURFACE_POINTS: usize = 6_000;
/// Rounds of tightening, each with the points that the one before left uncovered.
const TIGHTEN_ROUNDS: usize = 4;
/// Surface points that the polish covers, at most. With few, spheres shrink between them and must grow back in the end.
const FINE_POINTS: usize = 12_000;
/// Distance of the lines by which the polish measures, as a fraction of the largest extent, at most. On coarser ones it
/// lowers what they see of U rather than U.
const POLISH_STEP: f64 = 1.0 / 100.0;
/// Distance of the lines that measure the result, as a fraction of the largest extent.
const MEASURE_STEP: f64 = 1.0 / 200.0;
/// A mesh whose volume is below this fraction of its largest extent cubed counts as a thin shell.
const THIN: f64 = 1e-6;

/// The largest number of spheres of a set: of at most 6,000 points that stand for the surface, each has three.
pub const MAX_SPHERES: usize = SURFACE_POINTS / 3;

/// Options of fitting a sphere set.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BuildOptions {
    /// Aim of the fit.
    pub fit: SphereFit,
    /// Seed of every random choice: the same seed gives the same bits on one thread or many.
    pub seed: u64,
    /// Independent starts, of which the best is kept; at least 1. Fits to shadows need half as many, and
    /// relocate spheres instead.
    pub restarts: usize,
    /// Attempts per start to leave a local minimum by teleporting a sphere; above 64 spheres in
    /// proportion fewer, as of `jumps`.
    pub teleports: usize,
    /// Whether to lower the outside volume of the union after the sum over spheres; the published method doesn't.
    pub polish: bool,
    /// Attempts per start of the polish to leave a local minimum.
    pub jumps: usize,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { fit: SphereFit::default(), seed: 1, restarts: 4, teleports: 10, polish: true, jumps: 40 }
    }
}

impl SphereSet {
    /// Fits `count` spheres that bound `mesh` with little volume outside of it, or, from there, hide what it hides.
    ///
    /// Fewer spheres result only where the mesh is too simple to need them. A mesh that isn't closed is filled where the
    /// lines of three directions agree that it has an inside; one that encloses nothing is covered as a shell. Both
    /// leave a note.
    ///
    /// # Errors
    /// A mesh without triangles, with indices out of range, with positions that are not finite or all in one place; a
    /// count of 0 or of more than [`MAX_SPHERES`].
    pub fn build(
        mesh: &Mesh,
        count: usize,
        options: &BuildOptions,
        progress: &dyn Progress,
    ) -> Result<Self, SceneError> {
        let is_start = options.fit == SphereFit::Shadow;
        // Fits to shadows find their own way out of local minima.
        let restarts = if is_start { options.restarts.div_ceil(2) } else { options.restarts };
        let options = &BuildOptions { restarts, ..*options };
        let build = Build::new(mesh, count, options, progress)?;
        let (published, polished) = build.fitted();
        let mut sets = build.bounded(published, polished);
        build.measure(&mut sets);
        // The polish sees lines of one direction and samples: where it is wrong by that, the published set stays.
        let less = |a: &SphereSet, b: &SphereSet| a.outside_volume_fraction.total_cmp(&b.outside_volume_fraction);
        let mut set = sets.into_iter().min_by(less).unwrap_or_default();
        if is_start {
            let bounding = build.mesh.normalized(&set.spheres);
            let mut fitted = [build.mesh.placed(&shadow::fit(&build.mesh, &bounding, options.seed, progress))];
            build.measure(&mut fitted);
            [set] = fitted;
        }
        Ok(Self { notes: build.notes, fit: options.fit, ..set })
    }

    /// [`SphereSet::build`], or its result for the same mesh, count and options.
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
        // Without `..`: what a mesh gains must be thought of here. Only its shape counts.
        let Mesh {
            positions,
            triangles,
            normals: _,
            colors: _,
            texture_coordinates: _,
            textures: _,
            masks: _,
            coverage: _,
        } = mesh;
        let key =
            CacheKey::new("spheres", VERSION).value(positions).value(triangles).value(&(count as u64)).value(options);
        let are_spheres = |set: &Self| {
            let is_sphere = |it: &Sphere| it.center.is_finite() && it.radius.is_finite() && it.radius >= 0.0;
            (1..=count).contains(&set.spheres.len()) && set.spheres.iter().all(is_sphere)
        };
        cache.get_or_compute(&key, are_spheres, || Self::build(mesh, count, options, progress))
    }
}

/// The stages of a build, and what they share.
struct Build<'a> {
    mesh: NormalizedMesh,
    count: usize,
    options: &'a BuildOptions,
    progress: &'a dyn Progress,
    /// The inside of the mesh, to which spheres are fitted; nothing for a shell.
    solid: Solid,
    /// The same by lines close enough for the polish, by which unions are measured meanwhile.
    measured: Solid,
    /// Whether the mesh encloses no volume.
    is_shell: bool,
    notes: Vec<String>,
}

/// Spheres, and the outside volume of their union once they bound the mesh.
type Candidate = (f64, Vec<DSphere>);

impl<'a> Build<'a> {
    /// Checks the input and finds what is inside the mesh.
    fn new(
        mesh: &Mesh,
        count: usize,
        options: &'a BuildOptions,
        progress: &'a dyn Progress,
    ) -> Result<Self, SceneError> {
        let mesh = NormalizedMesh::new(mesh)?;
        if count == 0 {
            return Err(SceneError::new("a sphere set of 0 spheres bounds nothing").with_remedy("ask for 1 or more"));
        }
        if count > MAX_SPHERES {
            return Err(SceneError::new(format!("{count} spheres are more than a mesh can use"))
                .with_remedy(format!("ask for at most {MAX_SPHERES}")));
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
        let is_shell = mesh_volume < THIN;
        if is_shell {
            solid = Solid::new(&[], 2, step);
            notes.push(
                "the mesh encloses no volume: its spheres cover it as a thin shell, and the outside volume is given as \
                 a fraction of a ball around the mesh"
                    .into(),
            );
        }
        let measured = if options.polish && step > POLISH_STEP {
            Solid::new(if is_shell { &[] } else { &mesh.corners }, 2, POLISH_STEP)
        } else {
            solid.clone()
        };
        Ok(Self { mesh, count, options, progress, solid, measured, is_shell, notes })
    }

    /// The best spheres of all starts: as published, and polished.
    fn fitted(&self) -> (Vec<DSphere>, Vec<DSphere>) {
        let area = self.mesh.corners.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
        let restarts = self.options.restarts.max(1);
        let fine = self.fine_points();
        // The work of one attempt grows with the count, and with many spheres one more or less matters little.
        let affordable = |attempts: usize| if self.count > 64 { attempts * 64 / self.count } else { attempts };
        let (teleports, jumps) = (affordable(self.options.teleports), affordable(self.options.jumps));
        let steps = 1 + teleports + if self.options.polish { 1 + jumps } else { 0 };
        self.progress.start("fitting spheres", (restarts * steps) as u64);
        let fitted: Vec<[Candidate; 2]> = (0..restarts as u64)
            .into_par_iter()
            .map(|restart| {
                let seed = self.options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(restart);
                let mut rng = Pcg64Mcg::seed_from_u64(seed);
                let published = self.published(teleports, &mut rng);
                let polished = if self.options.polish {
                    let polish = Polish::new(&self.measured.columns, &fine, area);
                    polish.improve(published.clone(), jumps, &mut rng, self.progress)
                } else {
                    published.clone()
                };
                [published, polished].map(|spheres| (self.bounded_outside(&spheres), spheres))
            })
            .collect();
        let best = |which: usize| {
            let of_start = |start: &&[Candidate; 2]| start[which].0;
            let least = fitted.iter().min_by(|a, b| of_start(a).total_cmp(&of_start(b)));
            least.map(|start| start[which].1.clone()).unwrap_or_default()
        };
        (best(0), best(1))
    }

    /// Points of the surface that the polish covers.
    fn fine_points(&self) -> Vec<DVec3> {
        if !self.options.polish {
            return Vec::new();
        }
        let mut rng = Pcg64Mcg::seed_from_u64(self.options.seed);
        let mut points = surface_points(&self.mesh.corners, (400 * self.count).clamp(3_000, FINE_POINTS), &mut rng);
        // Samples miss sharp corners, which cost the most to cover afterwards. Many vertices are near to samples.
        points.extend(
            Some(self.mesh.vertices()).filter(|vertices| 2 * vertices.len() < points.len()).unwrap_or_default(),
        );
        points
    }

    /// Spheres of one start by the published method.
    fn published(&self, teleports: usize, rng: &mut Pcg64Mcg) -> Vec<DSphere> {
        let surface = surface_points(&self.mesh.corners, (30 * self.count).clamp(400, SURFACE_POINTS), rng);
        let inner = inner_points(&self.solid.columns, self.mesh.bounds, surface.len() / 2);
        let target = Target::new(&self.solid.columns, [surface, inner].concat());
        target.fit(self.count, teleports, rng, self.progress)
    }

    /// The outside volume of spheres after bounding, which counts, not that before.
    fn bounded_outside(&self, spheres: &[DSphere]) -> f64 {
        let mut bounded = spheres.to_vec();
        grow_to_cover(&self.mesh.corners, &mut bounded, 10.0 * COVER_TOLERANCE, |r| r);
        self.measured.columns.union_outside(&bounded)
    }

    /// Sets that bound the mesh: of polished spheres, tightened before, and beside them of those as published; without a
    /// polish of the latter alone.
    fn bounded(&self, published: Vec<DSphere>, mut polished: Vec<DSphere>) -> Vec<SphereSet> {
        if self.options.polish {
            self.tighten(&mut polished);
        }
        self.progress.start("bounding the triangles", 1);
        let mut sets = vec![self.mesh.bound(polished)];
        if self.options.polish {
            sets.push(self.mesh.bound(published));
        }
        self.progress.advance(1);
        sets
    }

    /// Fits each sphere to the points that it alone covers, round by round.
    fn tighten(&self, spheres: &mut [DSphere]) {
        self.progress.start("tightening spheres", TIGHTEN_ROUNDS as u64);
        let mut points: Vec<DVec3> = self.mesh.vertices();
        for round in 0..TIGHTEN_ROUNDS {
            // Triangles reach out between their vertices: where they do, their pieces join the points to be covered.
            if round > 0 {
                points.extend(uncovered_points(&self.mesh.corners, spheres, 10.0 * COVER_TOLERANCE));
            }
            cover_points(spheres, &points);
            tighten(&self.measured.columns, &points, spheres, 2);
            self.progress.advance(1);
        }
    }

    /// Estimates the outside and the missing volume of each set by lines along each axis.
    fn measure(&self, sets: &mut [SphereSet]) {
        let estimates: Vec<Vec<[f64; 2]>> = (0..3usize)
            .into_par_iter()
            .map(|axis| {
                let corners = if self.is_shell { &[] } else { self.mesh.corners.as_slice() };
                let columns = Solid::new(corners, axis, MEASURE_STEP).columns;
                let whole = if self.is_shell { sphere_volume(0.5 * self.mesh.extent()) } else { columns.volume() };
                let volume = columns.volume();
                let of_set = |set: &SphereSet| {
                    let [outside, inside] = columns.union_parts(&self.mesh.normalized(&set.spheres));
                    [outside / whole, (volume - inside).max(0.0) / whole]
                };
                sets.iter().map(of_set).collect()
            })
            .collect();
        for (k, set) in sets.iter_mut().enumerate() {
            let (low, high) =
                estimates.iter().fold((f64::INFINITY, 0.0f64), |(l, h), e| (l.min(e[k][0]), h.max(e[k][0])));
            let mean = |part: usize| estimates.iter().map(|e| e[k][part]).sum::<f64>() / 3.0;
            (set.outside_volume_fraction, set.missing_volume_fraction) = (mean(0), mean(1));
            set.outside_volume_error = 0.5 * (high - low);
        }
    }
}

fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

#[cfg(test)]
mod tests;
