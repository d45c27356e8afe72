//! Receiver clusters: groups of neighbouring receivers of an object that share a cut [Guerrero2007, 4.1 "Receiver point
//! clusters"].

use glam::{DVec3, Vec3};
use halfshade_scene::{Deformed, Mesh, Object, Pose, Scene, Sphere, SurfacePoint, cluster, clusters::bounding_sphere};
use std::sync::Arc;

/// Receivers per cluster of an object that doesn't say how many clusters it has: the thesis's scenes have 400 to 800.
const RECEIVERS_PER_CLUSTER: usize = 600;

/// Fewest receivers per cluster, and most clusters, of such an object.
const FEWEST_PER_CLUSTER: usize = 16;
const MOST_CLUSTERS: usize = 256;

/// A cluster of an object's receivers, in the object's space.
#[derive(Debug, Clone)]
pub(crate) struct ReceiverCluster {
    pub(crate) bound: Sphere,
    /// Unit mean of its receivers' normals; any if they cancel.
    pub(crate) normal: DVec3,
    /// Its vertices, if they move within the object.
    members: Vec<u32>,
}

impl ReceiverCluster {
    /// The cluster with its vertices where they are now.
    fn followed(&self, deformed: Option<&Deformed>) -> Self {
        let Some(deformed) = deformed.filter(|_| !self.members.is_empty()) else { return self.clone() };
        let of = |list: &[Vec3]| self.members.iter().map(|&v| list[v as usize].as_dvec3()).collect::<Vec<_>>();
        let (center, radius) = bounding_sphere(&of(&deformed.positions));
        let normal = of(&deformed.normals).iter().sum::<DVec3>().normalize_or(DVec3::Y);
        Self { bound: Sphere { center: center.as_vec3(), radius: radius as f32 }, normal, members: Vec::new() }
    }
}

/// The clusters of one object's receivers.
#[derive(Debug)]
pub(crate) struct ObjectClusters {
    mesh: Arc<Mesh>,
    /// The cluster of each vertex.
    of_vertex: Vec<u32>,
    clusters: Vec<ReceiverCluster>,
}

impl ObjectClusters {
    /// All of them, with their vertices where they are now.
    pub(crate) fn followed(&self, deformed: Option<&Deformed>) -> impl Iterator<Item = ReceiverCluster> {
        self.clusters.iter().map(move |cluster| cluster.followed(deformed))
    }

    /// The cluster of a point of the surface, which is that of the vertex with the largest weight; `None` elsewhere.
    pub(crate) fn of(&self, surface: SurfacePoint) -> Option<u32> {
        let vertex = surface.weights(&self.mesh)?.nearest();
        self.of_vertex.get(vertex).copied()
    }
}

/// The receiver clusters of every object.
pub(crate) fn clusters(scene: &Scene) -> Vec<Arc<ObjectClusters>> {
    let sizes: Vec<Option<f64>> = (scene.objects.iter().zip(scene.frame(0).world_from_object))
        .map(|(object, pose)| size(object, &pose))
        .collect();
    let of = |(number, object): (usize, &Object)| {
        let count = match object.cluster_count {
            0 => default_count(scene, number, &sizes),
            count => count,
        };
        let clusters = cluster(&object.mesh.positions, count, 0);
        let mut normals = vec![DVec3::ZERO; clusters.bounds.len()];
        for (normal, &own) in object.mesh.normals.iter().zip(&clusters.assignment) {
            normals[own as usize] += normal.as_dvec3();
        }
        let mut members = vec![Vec::new(); clusters.bounds.len()];
        if object.skin.is_some() {
            for (vertex, &own) in clusters.assignment.iter().enumerate() {
                members[own as usize].push(vertex as u32);
            }
        }
        let all = (clusters.bounds.into_iter().zip(normals).zip(members))
            .map(|((bound, normal), members)| ReceiverCluster { bound, normal: normal.normalize_or(DVec3::Y), members })
            .collect();
        Arc::new(ObjectClusters { mesh: object.mesh.clone(), of_vertex: clusters.assignment, clusters: all })
    };
    scene.objects.iter().enumerate().map(of).collect()
}

/// Half the diagonal of an object's box in the world.
fn size(object: &Object, pose: &Pose) -> Option<f64> {
    let (low, high) = object.mesh.bounds()?;
    let size = 0.5 * f64::from(pose.scale) * (high - low).as_dvec3().length();
    (size > 0.0 && size.is_finite()).then_some(size)
}

/// How many clusters an object has that doesn't say.
///
/// From within a cluster that surrounds a blocker no sphere of it is small: a cluster is to be no larger than the smallest
/// other object that blocks, so that a wide ground has near and far parts. That is the squared ratio of their sizes for a
/// surface; but no fewer than its vertices ask for, and no more than they can fill.
fn default_count(scene: &Scene, number: usize, sizes: &[Option<f64>]) -> usize {
    let receivers = scene.objects[number].mesh.positions.len();
    let others = scene.objects.iter().enumerate().filter(|&(other, object)| other != number && object.sphere_count > 0);
    let smallest = others.filter_map(|(other, _)| sizes[other]).reduce(f64::min);
    let by_size = sizes[number].zip(smallest).map_or(0.0, |(own, smallest)| (own / smallest).powi(2).ceil());
    let most = receivers.div_ceil(FEWEST_PER_CLUSTER).min(MOST_CLUSTERS);
    (by_size as usize).min(most).max(receivers.div_ceil(RECEIVERS_PER_CLUSTER))
}
