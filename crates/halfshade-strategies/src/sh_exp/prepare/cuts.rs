//! Which spheres a receiver sees: all leaves, or for each cluster of receivers what its distance allows
//! [Guerrero2007, 4.2 "Using sphere hierarchies"].
//!
//! From a cluster with bounding sphere (x_c, r_c), a sphere (x_s, r_s) is seen under at most
//!
//! ```text
//! θ_max = asin(r_s / (|x_s - x_c| - r_c))        (eq. 4.8)
//! ```
//!
//! [`Levels::Cluster`] takes for each object the coarsest level in which no sphere exceeds a threshold. [`Levels::Tree`] goes
//! down the hierarchy as \[Ren2006\] does and stops sphere by sphere. So that borders of clusters don't show, the log
//! blocker of a parent is scaled band by band to what its children would give at the cluster's centre:
//!
//! ```text
//! W_l = Σ_m F_b,lm F_d,lm / Σ_m F_b,lm²        (eq. 4.9)        F_b of the parent, F_d the sum over its children
//! ```
//!
//! or, with [`Ratios::Leaves`], over its leaves: a ratio to the next finer level leaves what lies below that out.
//!
//! Reflected light has a ratio of its own, see [`Cuts::set_reflection_ratios`].
//!
//! A receiver belongs to the cluster of the vertex next to it.

use super::placed::{PlacedObject, PlacedSpheres, placed};
use crate::{
    sh_exp::{
        bake::{CutSettings, clusters::ObjectClusters},
        kernel::Blocker,
        settings::{Levels, Ratios},
    },
    shared::light_space::LightSpace,
};
use glam::{DVec3, Vec3};
use halfshade_scene::{Frame, Receivers};
use halfshade_sh::{
    blocker_table::BlockerTable,
    kernel::{self, MAX_BANDS},
};
use std::sync::Arc;
use wide::f32x8;

/// The spheres that receivers see, by cluster.
#[derive(Debug, Clone)]
pub(crate) struct Cuts {
    cuts: Vec<Vec<Blocker>>,
    /// Per object its clusters where they are; none if there is one cut for all.
    clusters: Vec<PlacedClusters>,
    /// Cuts of the receivers around each sphere of every level, in the order of the emitters.
    of_emitters: Vec<u32>,
    /// Clusters whose cut has parents in it, if what these reflect is scaled.
    coarse: Vec<CoarseCut>,
}

/// The clusters of an object in light space.
#[derive(Debug, Clone)]
struct PlacedClusters {
    object: Arc<ObjectClusters>,
    centers: Vec<Vec3>,
    /// The cut of the first; those of the others follow.
    first_cut: u32,
}

/// A cut with parents in it, beside its refinement.
#[derive(Debug, Clone)]
pub(crate) struct CoarseCut {
    cut: usize,
    /// Centre and mean normal of the cluster.
    pub(crate) place: [f32; 3],
    pub(crate) normal: [f32; 3],
    /// The cut with all parents replaced by their children, and for each of its spheres the one in the cut.
    pub(crate) refined: Vec<Blocker>,
    origin: Vec<usize>,
}

/// Whose cut a receiver takes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum CutOf<'a> {
    /// That of its cluster.
    Cluster,
    /// That of the sphere of this number, receiver by receiver.
    Emitter(&'a [u32]),
}

impl Default for Cuts {
    /// Nothing to see.
    fn default() -> Self {
        Self { cuts: vec![Vec::new()], clusters: Vec::new(), of_emitters: Vec::new(), coarse: Vec::new() }
    }
}

impl Cuts {
    /// For `frame`; `clusters` is empty or has an entry per object. `logs` are the log blockers by angular radius, if
    /// blockers are logarithms.
    pub(crate) fn new(
        frame: &Frame<'_>,
        spheres: &PlacedSpheres,
        clusters: &[Arc<ObjectClusters>],
        logs: Option<&BlockerTable>,
        settings: &CutSettings,
    ) -> Self {
        let PlacedSpheres { objects, space, .. } = spheres;
        let mut cuts = Self { cuts: Vec::new(), ..Self::default() };
        if settings.levels == Levels::Leaves {
            cuts.cuts.push(objects.iter().flat_map(|object| object.level(0)).collect());
            return cuts;
        }
        let cut = |center: DVec3, radius: f64| -> Vec<(usize, Blocker)> {
            let view = View { center, radius, logs: logs.filter(|_| settings.ratios != Ratios::Off), settings };
            let of_object =
                |(number, object): (usize, &PlacedObject)| view.cut(object).into_iter().map(move |b| (number, b));
            objects.iter().enumerate().flat_map(of_object).collect()
        };
        for (number, (clusters, pose)) in clusters.iter().zip(&frame.world_from_object).enumerate() {
            let first_cut = cuts.cuts.len() as u32;
            let mut centers = Vec::new();
            for cluster in clusters.followed(frame.deformed(number)) {
                let (place, radius) = placed(&cluster.bound, pose);
                let place = space.place(place);
                let normal = space.rotation * (pose.rotation.as_dquat() * cluster.normal);
                let cut = cut(place, radius);
                centers.push(place.as_vec3());
                let number = cuts.cuts.len();
                if settings.ratios == Ratios::On {
                    cuts.coarse.extend(CoarseCut::new(number, &cut, objects, place, normal));
                }
                cuts.cuts.push(blockers(&cut));
            }
            cuts.clusters.push(PlacedClusters { object: clusters.clone(), centers, first_cut });
        }
        if cuts.cuts.is_empty() {
            // No cluster, no receiver: but there is always a first cut.
            cuts.cuts.push(Vec::new());
        }
        for &(place, radius) in objects.iter().flat_map(|object| &object.spheres).flatten() {
            cuts.of_emitters.push(cuts.cuts.len() as u32);
            cuts.cuts.push(blockers(&cut(place, radius)));
        }
        cuts
    }

    /// The blockers of a cut.
    pub(crate) fn cut(&self, number: usize) -> &[Blocker] {
        &self.cuts[number]
    }

    /// The blockers of every cut.
    pub(crate) fn all(&self) -> impl Iterator<Item = &[Blocker]> {
        self.cuts.iter().map(Vec::as_slice)
    }

    /// Blockers of the largest cut.
    pub(crate) fn largest(&self) -> usize {
        let refined = self.coarse.iter().map(|coarse| coarse.refined.len());
        self.cuts.iter().map(Vec::len).chain(refined).max().unwrap_or(0)
    }

    /// Scales what parents reflect to what their children do at the cluster's centre, for a receiver with the cluster's
    /// mean normal, the centre having none of its own:
    ///
    /// ```text
    /// w = Σ over children j of L̃_j Ṽ_j / (L̃ Ṽ)
    /// ```
    ///
    /// that is eq. 4.34 upside down, which as printed leads away from the detailed value when eq. 4.35 multiplies by it.
    /// Summed over colours, and held in [0, 4]: where a parent is hardly visible the quotient says nothing. It isn't the
    /// default: on the vases' ground it takes a twentieth off errors, on the vases, whose clusters have their centres
    /// inside, it is worse than none (`ratios_of_reflections_were_decided_by_experiment`).
    /// `parts` gives L̃ Ṽ of all spheres of a list.
    pub(crate) fn set_reflection_ratios(&mut self, mut parts: impl FnMut(&CoarseCut, &[Blocker]) -> Vec<(u32, f32)>) {
        for coarse in &self.coarse {
            let cut = &mut self.cuts[coarse.cut];
            let place_of = |blockers: &[Blocker], emitter| blockers.iter().position(|b| b.emitter == emitter);
            let mut detailed = vec![0.0; cut.len()];
            for (emitter, part) in parts(coarse, &coarse.refined) {
                if let Some(place) = place_of(&coarse.refined, emitter) {
                    detailed[coarse.origin[place]] += part;
                }
            }
            for (emitter, part) in parts(coarse, cut) {
                if let Some(place) = place_of(cut, emitter) {
                    let ratio = detailed[place] / part;
                    cut[place].reflection_factor = if ratio.is_finite() { ratio.clamp(0.0, 4.0) } else { 1.0 };
                }
            }
        }
    }

    /// Whether receivers see different spheres by where they are.
    pub(crate) fn is_by_cluster(&self) -> bool {
        !self.clusters.is_empty()
    }

    /// The cut of the receivers around a sphere.
    pub(crate) fn of_emitter(&self, emitter: u32) -> u32 {
        self.of_emitters[emitter as usize]
    }

    /// Clusters whose cut has parents in it.
    pub(crate) fn is_coarse(&self) -> bool {
        !self.coarse.is_empty()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.cuts.iter().map(|cut| size_of_val(cut.as_slice())).sum()
    }

    /// The cut of each receiver; `None` if they all share the first.
    pub(crate) fn of(&self, receivers: Receivers<'_>, space: &LightSpace, whose: CutOf<'_>) -> Option<Vec<u32>> {
        if !self.is_by_cluster() {
            return None;
        }
        let of_cluster = |i: usize| {
            let clusters = self.clusters.get(receivers.object[i] as usize)?;
            let cluster = clusters.object.of(receivers.surface[i]).or_else(|| {
                let position = space.place(receivers.position_at(i).as_dvec3());
                clusters.nearest(position.as_vec3())
            });
            Some(clusters.first_cut + cluster?)
        };
        let of = |i: usize| match whose {
            CutOf::Cluster => of_cluster(i).unwrap_or(0),
            CutOf::Emitter(numbers) => self.of_emitter(numbers[i]),
        };
        Some((0..receivers.len()).map(of).collect())
    }
}

/// The spheres of a cut, whoever's they are.
fn blockers(cut: &[(usize, Blocker)]) -> Vec<Blocker> {
    cut.iter().map(|(_, blocker)| *blocker).collect()
}

impl CoarseCut {
    /// The cut of this number with all parents replaced by their children, for a cluster about `place`; `None` if it has no
    /// parents.
    fn new(
        number: usize,
        cut: &[(usize, Blocker)],
        objects: &[PlacedObject],
        place: DVec3,
        normal: DVec3,
    ) -> Option<Self> {
        let (mut refined, mut origin) = (Vec::new(), Vec::new());
        for (place, (object, blocker)) in cut.iter().enumerate() {
            refined.extend(objects[*object].children_of(blocker));
            origin.resize(refined.len(), place);
        }
        let (place, normal) = (place.as_vec3().to_array(), normal.as_vec3().to_array());
        (refined.len() > cut.len()).then_some(Self { cut: number, place, normal, refined, origin })
    }
}

impl PlacedClusters {
    /// The cluster with the nearest centre: for receivers that lie nowhere on the mesh.
    fn nearest(&self, position: Vec3) -> Option<u32> {
        let distance = |number: &usize| position.distance_squared(self.centers[*number]);
        let nearest = (0..self.centers.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|number| number as u32)
    }
}

/// A cluster, by which cuts are decided.
struct View<'a> {
    center: DVec3,
    radius: f64,
    /// With which ratios are found; `None`: no ratios.
    logs: Option<&'a BlockerTable>,
    settings: &'a CutSettings,
}

impl View<'_> {
    /// Whether a sphere is seen small enough from everywhere in the cluster.
    fn allows(&self, &(center, radius): &(DVec3, f64)) -> bool {
        radius <= self.settings.threshold_sine * (center.distance(self.center) - self.radius)
    }

    /// The spheres of an object that the cluster sees.
    fn cut(&self, object: &PlacedObject) -> Vec<Blocker> {
        match self.settings.levels {
            Levels::Leaves => object.level(0).collect(),
            Levels::Cluster => {
                let fits = |&level: &usize| object.spheres[level].iter().all(|sphere| self.allows(sphere));
                let level = (1..object.levels.len()).rev().find(fits).unwrap_or(0);
                (0..object.spheres[level].len()).map(|i| self.scaled(object, level, i)).collect()
            }
            Levels::Tree => {
                let top = object.levels.len() - 1;
                let mut open: Vec<(usize, u32)> = (0..object.spheres[top].len() as u32).map(|i| (top, i)).collect();
                let mut cut = Vec::new();
                while let Some((level, i)) = open.pop() {
                    let children = &object.levels[level].children[i as usize];
                    if level == 0 || self.allows(&object.spheres[level][i as usize]) {
                        cut.push(self.scaled(object, level, i as usize));
                    } else {
                        open.extend(children.iter().map(|&child| (level - 1, child)));
                    }
                }
                cut
            }
        }
    }

    /// A sphere, scaled to what its children or its leaves give at the cluster's centre.
    fn scaled(&self, object: &PlacedObject, level: usize, i: usize) -> Blocker {
        let mut blocker = object.blocker(level, i);
        let is_leaf = object.levels[level].children[i].is_empty();
        if let Some(logs) = self.logs.filter(|_| !is_leaf) {
            let finer = if self.settings.ratios == Ratios::Leaves {
                object.leaves_of(level, i)
            } else {
                object.children_of(&blocker)
            };
            let place = self.center.as_vec3().to_array();
            let ratio =
                halfshade_sh::dispatch_bands!(self.settings.bands, N => ratio::<N>(logs, &blocker, &finer, place));
            let ratio = ratio.unwrap_or([1.0; MAX_BANDS]);
            blocker.factors.iter_mut().zip(ratio).for_each(|(factor, ratio)| *factor *= ratio);
        }
        blocker
    }
}

/// W_l at `place` (eq. 4.9); 1 where the parent has nothing to scale.
fn ratio<const N: usize>(
    logs: &BlockerTable,
    parent: &Blocker,
    finer: &[Blocker],
    place: [f32; 3],
) -> [f32; MAX_BANDS] {
    let mut bounding = [f32x8::ZERO; N];
    add_log(logs, parent, place, &mut bounding);
    let mut detailed = [f32x8::ZERO; N];
    finer.iter().for_each(|sphere| add_log(logs, sphere, place, &mut detailed));
    std::array::from_fn(|l| {
        let band = |a: &[f32x8; N], b: &[f32x8; N]| -> f32 {
            (l * l..((l + 1) * (l + 1)).min(N)).map(|i| a[i].as_array()[0] * b[i].as_array()[0]).sum()
        };
        let ratio = band(&bounding, &detailed) / band(&bounding, &bounding);
        if ratio.is_finite() { ratio } else { 1.0 }
    })
}

/// Adds the log blocker of a sphere as seen from `place`, in every lane the same.
fn add_log<const N: usize>(logs: &BlockerTable, blocker: &Blocker, place: [f32; 3], sum: &mut [f32x8; N]) {
    let offset: [f32; 3] = std::array::from_fn(|axis| blocker.center[axis] - place[axis]);
    let squared = offset.iter().map(|x| x * x).sum::<f32>();
    if squared > 0.0 {
        let zonal = logs.lookup::<N>(f32x8::splat((blocker.radius * blocker.radius / squared).min(1.0)));
        let direction = offset.map(|x| f32x8::splat(x / squared.sqrt()));
        kernel::accumulate_lobe(direction, &blocker.times_factors(zonal), sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        sh_exp::{
            bake::{clusters, hierarchy::Hierarchies},
            settings::Overlap,
        },
        shared::test_scenes::with_spheres,
    };
    use halfshade_scene::{Environment, Motion, Pose, ReceiverBuffer, Sphere, SphereSet, builtin::shapes};

    /// A ball of 48 spheres stands on a ground 30 times as wide. Without a number of clusters most of the ground sees few of
    /// them; one cluster sees all.
    #[test]
    fn wide_ground_has_near_and_far_clusters() {
        let spheres = (0..48).map(|i| {
            let z = -1.0 + 2.0 * (i as f32 + 0.5) / 48.0;
            let (sin, cos) = (2.4 * i as f32).sin_cos();
            let across = (1.0 - z * z).sqrt();
            Sphere { center: 0.7 * Vec3::new(across * cos, z, across * sin), radius: 0.3 }
        });
        let set = SphereSet { spheres: spheres.collect(), ..SphereSet::default() };
        let whole = Sphere { center: Vec3::Y, radius: 1.0 };
        let mut scene = with_spheres(Environment::constant(Vec3::ONE), &[whole]);
        let mut ball = scene.objects[0].clone();
        ball.mesh = Arc::new(shapes::sphere(8));
        (ball.sphere_count, ball.spheres, ball.cluster_count) = (48, Some(Arc::new(set)), 0);
        let mut ground = ball.clone();
        (ground.mesh, ground.sphere_count, ground.spheres) = (Arc::new(shapes::plane(64)), 0, None);
        ground.motion = Motion::Still(Pose { scale: 30.0, ..Pose::IDENTITY });
        scene.objects = vec![ball, ground];
        let visited = |levels, count: usize| {
            let mut scene = scene.clone();
            scene.objects[1].cluster_count = count;
            let mut hierarchies = Hierarchies::new(&scene, Overlap::Independent, Some(4));
            let threshold_sine = 15f64.to_radians().sin();
            let settings = CutSettings { levels, threshold_sine, ratios: Ratios::Off, bands: 4 };
            let frame = scene.frame(0);
            let spheres = PlacedSpheres::new(&frame, &mut hierarchies).unwrap();
            let cuts = Cuts::new(&frame, &spheres, &clusters::clusters(&scene), None, &settings);
            let receivers = ReceiverBuffer::vertices(&frame);
            let first = scene.objects[0].mesh.positions.len();
            let numbers = cuts.of(receivers.view(), &spheres.space, CutOf::Cluster).unwrap();
            let sizes = numbers[first..].iter().map(|&cut| cuts.cut(cut as usize).len());
            sizes.sum::<usize>() as f64 / (numbers.len() - first) as f64
        };
        for levels in [Levels::Cluster, Levels::Tree] {
            let (one, default) = (visited(levels, 1), visited(levels, 0));
            assert!(one == 48.0 && default < 16.0, "{levels:?}: {one} spheres with one cluster, {default} by default");
        }
    }
}
