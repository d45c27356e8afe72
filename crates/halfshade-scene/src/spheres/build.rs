//! From a mesh to its sphere set: normalize, sample, fit, bound, measure.

use super::cover::{grow_to_cover, sort_and_dedup, uncovered_points, violation};
use super::points::{inner_points, surface_points};
use super::polish::{Polish, cover_points, tighten};
use super::solid::Solid;
use super::variational::Target;
use super::{DSphere, Sphere, SphereSet};
use crate::cache::CacheKey;
use crate::clusters::at_least;
use crate::{Cache, CacheOutcome, Mesh, Progress, Scene, SceneError};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Raise whenever the same mesh and options would give another set.
const VERSION: u32 = 5;
/// Longest edge, as a fraction of the mesh's largest extent, below which an uncovered piece of a triangle is covered by
/// growing a sphere instead of being cut further.
const COVER_TOLERANCE: f64 = 2e-4;
/// Surface points to which spheres are fitted, at most.
const SURFACE_POINTS: usize = 6_000;
/// Rounds of tightening, each with the points that the one before left uncovered.
const TIGHTEN_ROUNDS: usize = 4;
/// Surface points that the polish covers, at most. With few, spheres shrink between them and must grow back in the end.
const FINE_POINTS: usize = 12_000;
/// Distance of the lines by which the polish measures, as a fraction of the largest extent, at most. On coarser ones it
/// lowers what they see of U rather than U.
const POLISH_STEP: f64 = 1.0 / 100.0;
/// Vertices that tightening respects at most; the bound holds for all of them in the end.
const MOST_VERTICES: usize = 40_000;
/// Distance of the lines that measure the result, as a fraction of the largest extent.
const MEASURE_STEP: f64 = 1.0 / 200.0;
/// A mesh whose volume is below this fraction of its largest extent cubed counts as a thin shell.
const THIN: f64 = 1e-6;

/// The largest number of spheres of a set: of at most 6,000 points that stand for the surface, each has three.
pub const MAX_SPHERES: usize = SURFACE_POINTS / 3;

/// How a sphere set is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BuildOptions {
    /// Seed of every random choice: the same seed gives the same bits on one thread or many.
    pub seed: u64,
    /// Independent starts, of which the best is kept; at least 1.
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
    /// count of 0 or of more than [`MAX_SPHERES`].
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
        let thin = mesh_volume < THIN;
        if thin {
            solid = Solid::new(&[], 2, step);
            notes.push(
                "the mesh encloses no volume: its spheres cover it as a thin shell, and the outside volume is given as \
                 a fraction of a ball around the mesh"
                    .into(),
            );
        }
        let measured = if options.polish && step > POLISH_STEP {
            Solid::new(if thin { &[] } else { &mesh.corners }, 2, POLISH_STEP)
        } else {
            solid.clone()
        };
        let area = mesh.corners.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
        let restarts = options.restarts.max(1);
        let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
        let fine = if options.polish {
            let mut points = surface_points(&mesh.corners, (400 * count).clamp(3_000, FINE_POINTS), &mut rng);
            // Samples miss sharp corners, which cost the most to cover afterwards. Many vertices are near to samples.
            points
                .extend(Some(mesh.vertices()).filter(|vertices| 2 * vertices.len() < points.len()).unwrap_or_default());
            points
        } else {
            Vec::new()
        };
        // The work of one attempt grows with the count, and with many spheres one more or less matters little.
        let affordable = |attempts: usize| if count > 64 { attempts * 64 / count } else { attempts };
        let (teleports, jumps) = (affordable(options.teleports), affordable(options.jumps));
        let steps = 1 + teleports + if options.polish { 1 + jumps } else { 0 };
        progress.start("fitting spheres", (restarts * steps) as u64);
        let fitted: Vec<[(f64, Vec<DSphere>); 2]> = (0..restarts as u64)
            .into_par_iter()
            .map(|restart| {
                let mut rng = Pcg64Mcg::seed_from_u64(options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(restart));
                let surface = surface_points(&mesh.corners, (30 * count).clamp(400, SURFACE_POINTS), &mut rng);
                let inner = inner_points(&solid.columns, mesh.bounds, surface.len() / 2);
                let target = Target::new(&solid.columns, [surface, inner].concat());
                let published = target.fit(count, teleports, &mut rng, progress);
                let polished = if options.polish {
                    Polish::new(&measured.columns, &fine, area).improve(published.clone(), jumps, &mut rng, progress)
                } else {
                    published.clone()
                };
                [published, polished].map(|spheres| {
                    // The volume after bounding counts, not that before.
                    let mut bounded = spheres.clone();
                    grow_to_cover(&mesh.corners, &mut bounded, 10.0 * COVER_TOLERANCE, |r| r);
                    (measured.columns.union_outside(&bounded), spheres)
                })
            })
            .collect();
        let best = |which: usize| {
            let of_start = |start: &&[(f64, Vec<DSphere>); 2]| start[which].0;
            let least = fitted.iter().min_by(|a, b| of_start(a).total_cmp(&of_start(b)));
            least.map(|start| start[which].1.clone()).unwrap_or_default()
        };
        let (published, mut polished) = (best(0), best(1));
        if options.polish {
            progress.start("tightening spheres", TIGHTEN_ROUNDS as u64);
            let mut points: Vec<DVec3> = mesh.vertices();
            for round in 0..TIGHTEN_ROUNDS {
                // Triangles reach out between their vertices: where they do, their pieces join the points to be covered.
                if round > 0 {
                    points.extend(uncovered_points(&mesh.corners, &polished, 10.0 * COVER_TOLERANCE));
                }
                cover_points(&mut polished, &points);
                tighten(&measured.columns, &points, &mut polished, 2);
                progress.advance(1);
            }
        }
        progress.start("bounding the triangles", 1);
        let mut sets = vec![mesh.bound(polished)];
        if options.polish {
            sets.push(mesh.bound(published));
        }
        progress.advance(1);
        let estimates: Vec<Vec<f64>> = (0..3usize)
            .into_par_iter()
            .map(|axis| {
                let corners = if thin { &[] } else { mesh.corners.as_slice() };
                let columns = Solid::new(corners, axis, MEASURE_STEP).columns;
                let whole = if thin { sphere_volume(0.5 * mesh.extent()) } else { columns.volume() };
                sets.iter().map(|set| columns.union_outside(&mesh.normalized(&set.spheres)) / whole).collect()
            })
            .collect();
        for (k, set) in sets.iter_mut().enumerate() {
            let (low, high) = estimates.iter().fold((f64::INFINITY, 0.0f64), |(l, h), e| (l.min(e[k]), h.max(e[k])));
            set.outside_volume_fraction = estimates.iter().map(|e| e[k]).sum::<f64>() / 3.0;
            set.outside_volume_error = 0.5 * (high - low);
        }
        // The polish sees lines of one direction and samples: where it is wrong by that, the published set stays.
        let less = |a: &SphereSet, b: &SphereSet| a.outside_volume_fraction.total_cmp(&b.outside_volume_fraction);
        let mut set = sets.into_iter().min_by(less).unwrap_or_default();
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

fn sphere_volume(radius: f64) -> f64 {
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
        sort_and_dedup(&mut vertices);
        let stride = vertices.len().div_ceil(MOST_VERTICES);
        vertices.into_iter().step_by(stride.max(1)).collect()
    }

    /// Diagonal of the bounding box, normalized.
    fn extent(&self) -> f64 {
        self.bounds[0].distance(self.bounds[1])
    }

    fn normalized(&self, spheres: &[Sphere]) -> Vec<DSphere> {
        spheres
            .iter()
            .map(|s| DSphere {
                center: (s.center.as_dvec3() - self.middle) / self.extent,
                radius: f64::from(s.radius) / self.extent,
            })
            .collect()
    }

    /// The spheres in single precision and the mesh's coordinates, grown until they bound the triangles as given.
    fn bound(&self, fitted: Vec<DSphere>) -> SphereSet {
        let triangles: Vec<[DVec3; 3]> =
            self.corners.iter().map(|t| t.map(|corner| corner * self.extent + self.middle)).collect();
        let mut spheres: Vec<DSphere> = fitted
            .iter()
            .filter(|sphere| sphere.radius > 0.0)
            .map(|sphere| DSphere {
                center: (sphere.center * self.extent + self.middle).as_vec3().as_dvec3(),
                radius: f64::from(at_least(sphere.radius * self.extent)),
            })
            .collect();
        let tolerance = COVER_TOLERANCE * self.extent;
        let growth = grow_to_cover(&triangles, &mut spheres, tolerance, |radius| f64::from(at_least(radius)));
        SphereSet {
            bounding_violation: violation(&triangles, &spheres, tolerance),
            growth: growth / (self.extent() * self.extent),
            spheres: spheres
                .iter()
                .map(|sphere| Sphere { center: sphere.center.as_vec3(), radius: sphere.radius as f32 })
                .collect(),
            ..SphereSet::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::{box_mesh, plane, torus};
    use crate::progress::Silent;
    use glam::Vec3;
    use rand::RngExt;

    const QUICK: BuildOptions = BuildOptions { seed: 1, restarts: 2, teleports: 1, polish: true, jumps: 1 };

    fn build(mesh: &Mesh, count: usize) -> SphereSet {
        SphereSet::build(mesh, count, &QUICK, &Silent).unwrap()
    }

    /// Random points of the triangles, none of which may lie outside every sphere.
    fn assert_bounds(mesh: &Mesh, set: &SphereSet) {
        assert_eq!(set.bounding_violation, 0.0);
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|k| mesh.positions[k as usize].as_dvec3());
            for _ in 0..40 {
                let (u, v): (f64, f64) = (rng.random(), rng.random());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let p = a + u * (b - a) + v * (c - a);
                let missing = |s: &Sphere| s.center.as_dvec3().distance(p) - f64::from(s.radius);
                let least = set.spheres.iter().map(missing).fold(f64::INFINITY, f64::min);
                assert!(least <= 1e-12 * p.length(), "{least}");
            }
        }
    }

    /// Against a volume estimate that shares nothing with the builder's: random points and the torus's equation.
    #[test]
    fn a_torus_is_bounded_and_its_outside_volume_is_true() {
        let mesh = torus(1.0, 0.4, 96, 48);
        let set = build(&mesh, 12);
        assert_bounds(&mesh, &set);
        assert!(set.notes.is_empty() && set.spheres.len() == 12);
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let (mut outside, count) = (0u32, 2_000_000);
        for _ in 0..count {
            let p =
                Vec3::new(1.6, 0.6, 1.6) * Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0f32)));
            let in_torus = (p.x.hypot(p.z) - 1.0).hypot(p.y) < 0.4;
            let in_spheres = set.spheres.iter().any(|s| s.center.distance(p) < s.radius);
            outside += u32::from(in_spheres && !in_torus);
        }
        let volume = 2.0 * std::f64::consts::PI.powi(2) * 0.4 * 0.4;
        let outside_torus = f64::from(outside) / f64::from(count) * (3.2 * 3.2 * 1.2);
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| mesh.positions[k as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        let mesh_volume: f64 = mesh.triangles.iter().map(tetrahedron).sum();
        // The mesh is inscribed in the torus: what it lacks is outside of it too.
        let fraction = (outside_torus + volume - mesh_volume) / mesh_volume;
        assert!((fraction / set.outside_volume_fraction - 1.0).abs() < 0.01, "{fraction} {set:?}");
        // Twelve spheres around a ring, each through the tube's rim at its ends.
        assert!(set.outside_volume_fraction < 0.6, "{}", set.outside_volume_fraction);
    }

    #[test]
    fn the_polish_pays() {
        let mut slab = box_mesh(2);
        slab.positions.iter_mut().for_each(|p| *p *= Vec3::new(1.0, 0.6, 0.3));
        // Sharp corners, which samples miss, and few spheres for much: there it once lost.
        let cases = [(torus(1.0, 0.6, 48, 24), 10), (box_mesh(2), 10), (slab, 5)];
        let ratios = cases.map(|(mesh, count)| {
            let published = SphereSet::build(&mesh, count, &BuildOptions { polish: false, ..QUICK }, &Silent).unwrap();
            assert_bounds(&mesh, &published);
            build(&mesh, count).outside_volume_fraction / published.outside_volume_fraction
        });
        assert!(ratios[0] < 1.0 && ratios[1] < 1.0 && ratios[2] <= 1.0, "{ratios:?}");
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let mesh = box_mesh(2);
        let with_threads =
            |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| build(&mesh, 5));
        let one = with_threads(1);
        assert_eq!(one, with_threads(3));
        let other = SphereSet::build(&mesh, 5, &BuildOptions { seed: 2, ..QUICK }, &Silent).unwrap();
        assert_ne!(one, other);
    }

    #[test]
    fn any_scale_and_place() {
        let mesh = torus(1.0, 0.5, 24, 12);
        let unit = build(&mesh, 6);
        for (scale, place) in [(1e-3, Vec3::ZERO), (1e3, Vec3::ZERO), (1.0, Vec3::new(500.0, -300.0, 0.0))] {
            let mut moved = mesh.clone();
            moved.positions.iter_mut().for_each(|p| *p = scale * *p + place);
            let set = build(&moved, 6);
            assert_bounds(&moved, &set);
            let ratio = set.outside_volume_fraction / unit.outside_volume_fraction;
            assert!((0.9..1.1).contains(&ratio), "scale {scale}: {ratio}");
        }
    }

    #[test]
    fn bad_meshes_are_bounded_too() {
        let sound = torus(1.0, 0.4, 24, 12);
        let mut flipped = sound.clone();
        flipped.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let mut open = sound.clone();
        open.triangles.truncate(sound.triangles.len() - 12);
        let mut split = Mesh::default();
        for t in &sound.triangles {
            split.triangles.push([0, 1, 2].map(|k| k + split.positions.len() as u32));
            split.positions.extend(t.map(|k| sound.positions[k as usize]));
        }
        let mut two = sound.clone();
        two.triangles.extend(sound.triangles.iter().map(|t| t.map(|k| k + sound.positions.len() as u32)));
        two.positions.extend(sound.positions.iter().map(|p| 0.7 * *p + Vec3::new(3.0, 0.2, 0.1)));
        for mesh in [&flipped, &open, &split, &two] {
            let set = build(mesh, 10);
            assert_bounds(mesh, &set);
            assert_eq!(set.notes.is_empty(), !std::ptr::eq(mesh, &open), "{:?}", set.notes);
            // Ten for two tori are few; one sphere around a torus would be 5.
            assert!(set.outside_volume_fraction < 4.0, "{}", set.outside_volume_fraction);
        }
        // Nothing inside: a shell, and said so.
        let flat = build(&plane(3), 7);
        assert_bounds(&plane(3), &flat);
        assert!(flat.notes[0].contains("no volume") && flat.outside_volume_fraction.is_finite());
        // More spheres than there is to cover, and one for all.
        let triangle = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 0, 0]],
            ..Mesh::default()
        };
        for count in [1, 30] {
            assert_bounds(&triangle, &build(&triangle, count));
        }
        let one = build(&box_mesh(1), 1);
        assert_bounds(&box_mesh(1), &one);
        assert!((f64::from(one.spheres[0].radius) - 3f64.sqrt()).abs() < 0.02, "{one:?}");
    }

    #[test]
    fn what_cannot_be_bounded_is_said() {
        let problem = |mesh: &Mesh, count| SphereSet::build(mesh, count, &QUICK, &Silent).unwrap_err().to_string();
        assert!(problem(&box_mesh(1), 0).contains("0 spheres"));
        assert!(problem(&box_mesh(1), MAX_SPHERES + 1).contains("at most 2000"));
        assert!(problem(&Mesh::default(), 3).contains("without triangles"));
        let mut broken = box_mesh(1);
        broken.positions[2].y = f32::NAN;
        assert!(problem(&broken, 3).contains("vertex 2 is not finite"));
        broken.positions.truncate(2);
        assert!(problem(&broken, 3).contains("a triangle uses vertex"));
        broken.positions = vec![Vec3::ONE; 100];
        assert!(problem(&broken, 3).contains("one place"));
    }

    #[test]
    fn the_cache_gives_the_same_set() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().into()));
        let ask = |count| SphereSet::build_cached(&box_mesh(1), count, &QUICK, &cache, &Silent).unwrap();
        let (first, second, other) = (ask(3), ask(3), ask(2));
        assert_eq!(first.0, second.0);
        use crate::cache::CacheSource::{Computed, Read};
        assert_eq!([first.1.source, second.1.source, other.1.source], [Computed, Read, Computed]);
    }

    #[test]
    fn the_built_in_scenes_get_all_their_spheres() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::open(Some(folder.path().into()));
        for (name, count) in [("vases", 20), ("ducks", 30), ("squirrel-and-balls", 14)] {
            let mut scene = crate::builtin::scene(name).unwrap();
            let notes = scene.build_spheres(&cache, &Silent).unwrap();
            assert_eq!(scene.built_sphere_count(), count, "{name}: {notes:?}");
        }
    }
}
