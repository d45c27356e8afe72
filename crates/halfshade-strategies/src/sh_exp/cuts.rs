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
//! Reflected light has a ratio of its own, see [`Cuts::set_reflection_ratios`].
//!
//! A receiver belongs to the cluster of the vertex next to it.

use super::{
    blockers::Blocker,
    clusters::ObjectClusters,
    levels::{Hierarchies, Level},
    settings::Levels,
};
use crate::shared::origin::origin_of;
use glam::{DMat3, DQuat, DVec3, Vec3};
use halfshade_scene::{Frame, Object, Pose, Receivers, Sphere};
use halfshade_sh::{
    blocker_table::BlockerTable,
    kernel::{self, MAX_BANDS},
};
use halfshade_strategy::StrategyError;
use std::sync::Arc;
use wide::f32x8;

/// How cuts are made.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutSettings {
    pub(super) choice: Levels,
    /// Sine of the largest angular radius of a sphere that isn't a leaf.
    pub(super) threshold_sine: f64,
    /// Whether parents are scaled to their children.
    pub(super) ratios: bool,
    /// Whether what they reflect is scaled too.
    pub(super) reflection_ratios: bool,
    pub(super) bands: usize,
}

/// The cuts of a frame, in the space of the light: turned like the environment, so that its tables hold for every turn, and
/// about an origin that is theirs.
#[derive(Debug, Clone)]
pub(super) struct Cuts {
    cuts: Vec<Vec<Blocker>>,
    /// Per object its clusters where they are; none if there is one cut for all.
    clusters: Vec<PlacedClusters>,
    /// Cuts of the receivers around each sphere of every level, in the order of the emitters.
    of_emitters: Vec<u32>,
    /// Clusters whose cut has parents in it, if ratios are wanted.
    coarse: Vec<CoarseCut>,
    /// How each sphere of every level has turned within its object since rest, in the order of the emitters.
    pub(super) turns: Vec<DQuat>,
    /// Light space from world space: `rotation · (point - center)`.
    pub(super) rotation: DMat3,
    pub(super) center: DVec3,
    /// A space that turns with what blocks, that of the first object with spheres, from light space: what is sampled in fixed
    /// directions there doesn't change when light and scene are turned, however the light's turn is described.
    pub(super) blockers_from_light: DMat3,
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
pub(super) struct CoarseCut {
    cut: usize,
    /// Centre and mean normal of the cluster.
    pub(super) place: [f32; 3],
    pub(super) normal: [f32; 3],
    /// The cut with all parents replaced by their children, and for each of its spheres the one in the cut.
    pub(super) refined: Vec<Blocker>,
    origin: Vec<usize>,
}

/// Whose cut a receiver takes.
#[derive(Debug, Clone, Copy)]
pub(super) enum CutOf<'a> {
    /// That of its cluster.
    Cluster,
    /// That of the sphere of this number, receiver by receiver.
    Emitter(&'a [u32]),
}

/// The spheres of one object in light space, level by level.
struct Placed {
    levels: Arc<[Level]>,
    spheres: Vec<Vec<(DVec3, f64)>>,
    /// Number of the first sphere of each level among all emitters.
    first: Vec<u32>,
}

impl Default for Cuts {
    fn default() -> Self {
        Self {
            cuts: vec![Vec::new()],
            clusters: Vec::new(),
            of_emitters: Vec::new(),
            coarse: Vec::new(),
            turns: Vec::new(),
            rotation: DMat3::IDENTITY,
            center: DVec3::ZERO,
            blockers_from_light: DMat3::IDENTITY,
        }
    }
}

impl Cuts {
    /// For `frame`; `clusters` is empty or has an entry per object. `logs` are the log blockers by angular radius, if
    /// blockers are logarithms.
    pub(super) fn new(
        frame: &Frame<'_>,
        levels: &mut Hierarchies,
        clusters: &[Arc<ObjectClusters>],
        logs: Option<&BlockerTable>,
        settings: &CutSettings,
    ) -> Result<Self, StrategyError> {
        let mut objects = Vec::new();
        let mut first = 0;
        let mut turns = Vec::new();
        for (number, (object, pose)) in frame.scene.objects.iter().zip(&frame.world_from_object).enumerate() {
            if object.sphere_count == 0 {
                continue;
            }
            let levels = levels.of(object).ok_or_else(|| {
                StrategyError::Failed(format!("object `{}` blocks but its sphere set is not built", object.name))
            })?;
            let mut place = |level: &Level| -> Vec<(DVec3, f64)> {
                let followed = level.followed(&object.mesh, frame.deformed(number));
                turns.extend(followed.iter().map(|followed| followed.rotation));
                followed.iter().map(|followed| placed(&followed.sphere, pose)).collect()
            };
            let spheres: Vec<Vec<(DVec3, f64)>> = levels.iter().map(&mut place).collect();
            let firsts = spheres.iter().map(|level| {
                first += level.len() as u32;
                first - level.len() as u32
            });
            objects.push(Placed { first: firsts.collect(), levels, spheres });
        }
        let leaves = objects.iter().flat_map(|object| &object.spheres[0]);
        let center = origin_of(leaves.map(|(center, _)| *center));
        let rotation = DMat3::from_quat(frame.world_from_environment.as_dquat().normalize().conjugate());
        for (place, _) in objects.iter_mut().flat_map(|object| &mut object.spheres).flatten() {
            *place = rotation * (*place - center);
        }

        let blocks = |(object, pose): (&Object, &Pose)| (object.sphere_count > 0).then_some(pose.rotation);
        let first = frame.scene.objects.iter().zip(&frame.world_from_object).find_map(blocks).unwrap_or_default();
        let blockers_from_light = DMat3::from_quat(first.as_dquat().normalize().conjugate()) * rotation.transpose();
        let mut cuts = Self { cuts: Vec::new(), turns, rotation, center, blockers_from_light, ..Self::default() };
        if settings.choice == Levels::Leaves {
            cuts.cuts.push(objects.iter().flat_map(|object| object.level(0)).collect());
            return Ok(cuts);
        }
        let view =
            |center: DVec3, radius: f64| View { center, radius, logs: logs.filter(|_| settings.ratios), settings };
        let cut = |center: DVec3, radius: f64| -> Vec<(usize, Blocker)> {
            let view = view(center, radius);
            let of_object =
                |(number, object): (usize, &Placed)| object.cut(&view).into_iter().map(move |b| (number, b));
            objects.iter().enumerate().flat_map(of_object).collect()
        };
        let blockers = |cut: &[(usize, Blocker)]| cut.iter().map(|(_, blocker)| *blocker).collect();
        for (number, (clusters, pose)) in clusters.iter().zip(&frame.world_from_object).enumerate() {
            let first_cut = cuts.cuts.len() as u32;
            let mut centers = Vec::new();
            for cluster in clusters.followed(frame.deformed(number)) {
                let (place, radius) = placed(&cluster.bound, pose);
                let place = rotation * (place - center);
                let (number, cut) = (cuts.cuts.len(), cut(place, radius));
                centers.push(place.as_vec3());
                let place = place.as_vec3().to_array();
                let (mut refined, mut origin) = (Vec::new(), Vec::new());
                for (place, (object, blocker)) in cut.iter().enumerate() {
                    refined.extend(objects[*object].children_of(blocker));
                    origin.resize(refined.len(), place);
                }
                if settings.ratios && refined.len() > cut.len() {
                    let normal = (rotation * (pose.rotation.as_dquat() * cluster.normal)).as_vec3().to_array();
                    cuts.coarse.push(CoarseCut { cut: number, place, normal, refined, origin });
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
        Ok(cuts)
    }

    /// The blockers of a cut.
    pub(super) fn cut(&self, number: usize) -> &[Blocker] {
        &self.cuts[number]
    }

    /// Blockers of the largest cut.
    pub(super) fn largest(&self) -> usize {
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
    pub(super) fn set_reflection_ratios(&mut self, mut parts: impl FnMut(&CoarseCut, &[Blocker]) -> Vec<(u32, f32)>) {
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

    /// Clusters whose cut has parents in it.
    pub(super) fn is_coarse(&self) -> bool {
        !self.coarse.is_empty()
    }

    pub(super) fn bytes(&self) -> usize {
        self.cuts.iter().map(|cut| size_of_val(cut.as_slice())).sum()
    }

    /// The cut of each receiver; `None` if they all share the first.
    pub(super) fn of(&self, receivers: Receivers<'_>, whose: CutOf<'_>) -> Option<Vec<u32>> {
        if self.clusters.is_empty() {
            return None;
        }
        let of_cluster = |i: usize| {
            let clusters = self.clusters.get(receivers.object[i] as usize)?;
            let cluster = clusters.object.of(receivers.surface[i]).or_else(|| {
                let position = self.rotation * (receivers.position_at(i).as_dvec3() - self.center);
                clusters.nearest(position.as_vec3())
            });
            Some(clusters.first_cut + cluster?)
        };
        let of = |i: usize| match whose {
            CutOf::Cluster => of_cluster(i).unwrap_or(0),
            CutOf::Emitter(numbers) => self.of_emitters[numbers[i] as usize],
        };
        Some((0..receivers.len()).map(of).collect())
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

fn placed(sphere: &Sphere, pose: &Pose) -> (DVec3, f64) {
    let center = pose.rotation.as_dquat() * (f64::from(pose.scale) * sphere.center.as_dvec3());
    (center + pose.translation.as_dvec3(), f64::from(pose.scale * sphere.radius))
}

/// What a cluster decides by.
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
}

impl Placed {
    fn cut(&self, view: &View<'_>) -> Vec<Blocker> {
        match view.settings.choice {
            Levels::Leaves => self.level(0).collect(),
            Levels::Cluster => {
                let fits = |&level: &usize| self.spheres[level].iter().all(|sphere| view.allows(sphere));
                let level = (1..self.levels.len()).rev().find(fits).unwrap_or(0);
                (0..self.spheres[level].len()).map(|i| self.scaled(level, i, view)).collect()
            }
            Levels::Tree => {
                let top = self.levels.len() - 1;
                let mut open: Vec<(usize, u32)> = (0..self.spheres[top].len() as u32).map(|i| (top, i)).collect();
                let mut cut = Vec::new();
                while let Some((level, i)) = open.pop() {
                    let children = &self.levels[level].children[i as usize];
                    if level == 0 || view.allows(&self.spheres[level][i as usize]) {
                        cut.push(self.scaled(level, i as usize, view));
                    } else {
                        open.extend(children.iter().map(|&child| (level - 1, child)));
                    }
                }
                cut
            }
        }
    }

    /// All spheres of a level as they are.
    fn level(&self, level: usize) -> impl Iterator<Item = Blocker> {
        (0..self.spheres[level].len()).map(move |i| self.blocker(level, i))
    }

    fn blocker(&self, level: usize, i: usize) -> Blocker {
        let (center, radius) = self.spheres[level][i];
        Blocker {
            center: center.as_vec3().to_array(),
            radius: radius as f32,
            factors: [self.levels[level].shares[i]; MAX_BANDS],
            emitter: self.first[level] + i as u32,
            reflection_factor: 1.0,
        }
    }

    /// The children of a blocker, as they are; itself if it is a leaf.
    fn children_of(&self, blocker: &Blocker) -> Vec<Blocker> {
        let level = self.first.partition_point(|&first| first <= blocker.emitter) - 1;
        let children = &self.levels[level].children[(blocker.emitter - self.first[level]) as usize];
        if children.is_empty() {
            return vec![*blocker];
        }
        children.iter().map(|&child| self.blocker(level - 1, child as usize)).collect()
    }

    /// A sphere, scaled to what its children give at the cluster's centre.
    fn scaled(&self, level: usize, i: usize, view: &View<'_>) -> Blocker {
        let mut blocker = self.blocker(level, i);
        let children = &self.levels[level].children[i];
        if let Some(logs) = view.logs.filter(|_| !children.is_empty()) {
            let children: Vec<Blocker> =
                children.iter().map(|&child| self.blocker(level - 1, child as usize)).collect();
            let place = view.center.as_vec3().to_array();
            let ratio =
                halfshade_sh::dispatch_bands!(view.settings.bands, N => ratio::<N>(logs, &blocker, &children, place));
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
    children: &[Blocker],
    place: [f32; 3],
) -> [f32; MAX_BANDS] {
    let mut bounding = [f32x8::ZERO; N];
    add_log(logs, parent, place, &mut bounding);
    let mut detailed = [f32x8::ZERO; N];
    children.iter().for_each(|child| add_log(logs, child, place, &mut detailed));
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
        sh_exp::{clusters, settings::Overlap},
        shared::test_scenes::with_spheres,
    };
    use halfshade_scene::{Environment, Motion, ReceiverBuffer, SphereSet, builtin::shapes};

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
        let visited = |choice, count: usize| {
            let mut scene = scene.clone();
            scene.objects[1].cluster_count = count;
            let mut levels = Hierarchies::new(&scene, Overlap::Independent, Some(4));
            let threshold_sine = 15f64.to_radians().sin();
            let settings = CutSettings { choice, threshold_sine, ratios: false, reflection_ratios: false, bands: 4 };
            let frame = scene.frame(0);
            let cuts = Cuts::new(&frame, &mut levels, &clusters::clusters(&scene), None, &settings).unwrap();
            let receivers = ReceiverBuffer::vertices(&frame);
            let first = scene.objects[0].mesh.positions.len();
            let numbers = cuts.of(receivers.view(), CutOf::Cluster).unwrap();
            let sizes = numbers[first..].iter().map(|&cut| cuts.cut(cut as usize).len());
            sizes.sum::<usize>() as f64 / (numbers.len() - first) as f64
        };
        for choice in [Levels::Cluster, Levels::Tree] {
            let (one, default) = (visited(choice, 1), visited(choice, 0));
            assert!(one == 48.0 && default < 16.0, "{choice:?}: {one} spheres with one cluster, {default} by default");
        }
    }
}
