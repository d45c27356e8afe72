//! Receiver clusters: groups of neighbouring receivers that share what is decided per group ([Guerrero2007, 4.1,
//! "Receiver point clusters"]).
//!
//! Lloyd's iteration with the centre of the smallest bounding sphere in place of the mean: a point joins the cluster
//! with the nearest centre, then every cluster's centre moves to where its bounding sphere is smallest. Neither step
//! enlarges the largest radius: a point that changes its cluster comes nearer to a centre, and the smallest bounding
//! sphere is no larger than the one about the old centre. The thesis finds the spheres by Powell's method; here they are
//! exact.

mod bounding_sphere;

pub use bounding_sphere::bounding_sphere;

use crate::Sphere;
use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Rounds after which the iteration stops at the latest.
const MAX_ROUNDS: usize = 100;
/// The iteration stops when the sum of the radii improves by less than this fraction.
const LEAST_IMPROVEMENT: f64 = 1e-4;
/// Rounds in a row without such an improvement before it stops, since the sum, unlike the largest radius, may rise in
/// between.
const PATIENCE: usize = 4;

/// Points in groups.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clusters {
    /// The cluster of each point.
    pub assignment: Vec<u32>,
    /// The smallest sphere around each cluster's points; every point lies inside its cluster's, rounding included.
    pub bounds: Vec<Sphere>,
}

/// Groups `positions` (finite) into `count` clusters, none of them empty.
///
/// `count` is limited to 1 ..= the number of points; no points give no clusters. The same seed gives the same clusters,
/// whatever the number of threads.
pub fn cluster(positions: &[Vec3], count: usize, seed: u64) -> Clusters {
    if positions.is_empty() {
        return Clusters::default();
    }
    let points: Vec<DVec3> = positions.iter().map(|p| p.as_dvec3()).collect();
    let around = |members: &[u32]| {
        let points: Vec<DVec3> = members.iter().map(|&k| points[k as usize]).collect();
        bounding_sphere(&points)
    };
    let (assignment, centers) = lloyd(&points, count.clamp(1, points.len()), seed, around);
    let mut bounds: Vec<Sphere> =
        centers.iter().map(|center| Sphere { center: center.as_vec3(), radius: 0.0 }).collect();
    for (point, &own) in points.iter().zip(&assignment) {
        let bound = &mut bounds[own as usize];
        bound.radius = bound.radius.max(at_least(point.distance(bound.center.as_dvec3())));
    }
    Clusters { assignment, bounds }
}

/// Lloyd's iteration on `points` (at least one) about `count` centres (1 ..= the number of points): the cluster of each
/// point, none empty, and the centres of the last assignment's bounding spheres. `bound` gives the centre and radius
/// of the smallest sphere around the points with the given indices, or around what they stand for.
pub(crate) fn lloyd(
    points: &[DVec3],
    count: usize,
    seed: u64,
    bound: impl Fn(&[u32]) -> (DVec3, f64) + Sync,
) -> (Vec<u32>, Vec<DVec3>) {
    let mut centers = spread_centers(points, count, seed);
    let (mut best, mut best_sum, mut without_improvement) = (None, f64::INFINITY, 0);
    for _ in 0..MAX_ROUNDS {
        let assignment = assign(points, &centers);
        let spheres: Vec<(DVec3, f64)> = members(&assignment, count).par_iter().map(|own| bound(own)).collect();
        centers = spheres.iter().map(|sphere| sphere.0).collect();
        let sum: f64 = spheres.iter().map(|sphere| sphere.1).sum();
        without_improvement = if sum < best_sum * (1.0 - LEAST_IMPROVEMENT) { 0 } else { without_improvement + 1 };
        if sum < best_sum {
            (best, best_sum) = (Some((assignment, centers.clone())), sum);
        }
        if without_improvement == PATIENCE || sum == 0.0 {
            break;
        }
    }
    best.unwrap_or_else(|| (vec![0; points.len()], centers))
}

/// The points of each cluster.
pub(crate) fn members(assignment: &[u32], count: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); count];
    for (k, &own) in assignment.iter().enumerate() {
        members[own as usize].push(k as u32);
    }
    members
}

/// The smallest `f32` that is not below `x`.
pub(crate) fn at_least(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}

/// Points chosen at random, each with probability in proportion to the squared distance from those chosen before: like
/// the thesis's random points, but never two in one place while there are others.
pub(crate) fn spread_centers(points: &[DVec3], count: usize, seed: u64) -> Vec<DVec3> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut centers = vec![points[random.random_range(0..points.len())]];
    let mut nearest_squared = vec![f64::INFINITY; points.len()];
    while centers.len() < count {
        let newest = centers[centers.len() - 1];
        let mut total = 0.0;
        for (nearest, point) in nearest_squared.iter_mut().zip(points) {
            *nearest = nearest.min(point.distance_squared(newest));
            total += *nearest;
        }
        let mut goal = random.random::<f64>() * total;
        let chosen = nearest_squared.iter().position(|&weight| {
            goal -= weight;
            goal < 0.0
        });
        centers.push(points[chosen.unwrap_or(points.len() - 1)]);
    }
    centers
}

/// The nearest centre of each point, the first of equals; a centre that is nobody's takes the point that lies farthest
/// from its own centre among those that are not alone.
pub(crate) fn assign(points: &[DVec3], centers: &[DVec3]) -> Vec<u32> {
    let nearest: Vec<(u32, f64)> = points
        .par_iter()
        .map(|point| {
            let mut best = (0, f64::INFINITY);
            for (i, center) in centers.iter().enumerate() {
                let squared = point.distance_squared(*center);
                if squared < best.1 {
                    best = (i as u32, squared);
                }
            }
            best
        })
        .collect();
    let mut members = vec![0usize; centers.len()];
    nearest.iter().for_each(|&(own, _)| members[own as usize] += 1);
    let (mut assignment, mut distance): (Vec<u32>, Vec<f64>) = nearest.into_iter().unzip();
    while let Some(empty) = members.iter().position(|&n| n == 0) {
        let movable = (0..points.len()).filter(|&i| members[assignment[i] as usize] > 1);
        // As many points as clusters at least: some cluster has two.
        let Some(farthest) = movable.reduce(|a, b| if distance[b] > distance[a] { b } else { a }) else { break };
        members[assignment[farthest] as usize] -= 1;
        members[empty] = 1;
        assignment[farthest] = empty as u32;
        distance[farthest] = 0.0;
    }
    assignment
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::builtin::tests::built;

    fn check(positions: &[Vec3], clusters: &Clusters, count: usize) {
        assert_eq!((clusters.assignment.len(), clusters.bounds.len()), (positions.len(), count));
        let mut members = vec![0; count];
        for (position, &own) in positions.iter().zip(&clusters.assignment) {
            members[own as usize] += 1;
            let bound = clusters.bounds[own as usize];
            let distance = position.as_dvec3().distance(bound.center.as_dvec3());
            assert!(distance <= f64::from(bound.radius), "{distance} outside {bound:?}");
        }
        assert!(members.iter().all(|&n| n > 0), "{members:?}");
    }

    fn largest(clusters: &Clusters) -> f32 {
        clusters.bounds.iter().map(|b| b.radius).fold(0.0, f32::max)
    }

    #[test]
    fn every_object_of_the_built_in_scenes_is_covered() {
        for name in ["vases", "squirrel-and-balls"] {
            let scene = built(name);
            for object in &scene.objects {
                let positions = &object.mesh.positions;
                let clusters = cluster(positions, object.cluster_count, 1);
                check(positions, &clusters, object.cluster_count);
                let whole = cluster(positions, 1, 1);
                // Half a sphere needs as large a sphere as all of it.
                let limit = if object.cluster_count < 4 { 1.0 + 1e-6 } else { 0.95 };
                assert!(largest(&clusters) <= limit * whole.bounds[0].radius, "{}", object.name);
            }
        }
    }

    #[test]
    fn separate_heaps_become_clusters() {
        let heap = builtin::shapes::sphere(3);
        let middles = [Vec3::ZERO, Vec3::new(10.0, 0.0, 0.0), Vec3::new(0.0, -9.0, 4.0), Vec3::new(3.0, 20.0, -30.0)];
        let positions: Vec<Vec3> = middles.iter().flat_map(|m| heap.positions.iter().map(move |p| *m + p)).collect();
        for seed in 0..20 {
            let clusters = cluster(&positions, 4, seed);
            check(&positions, &clusters, 4);
            assert!(clusters.bounds.iter().all(|b| (b.radius - 1.0).abs() < 1e-5), "{seed}: {:?}", clusters.bounds);
            for own in clusters.assignment.chunks(heap.positions.len()) {
                assert!(own.iter().all(|&c| c == own[0]));
            }
        }
    }

    #[test]
    fn a_square_is_divided_nearly_evenly() {
        let plane = builtin::shapes::plane(40).positions;
        for seed in 0..5 {
            let clusters = cluster(&plane, 16, seed);
            check(&plane, &clusters, 16);
            // A hexagon of a sixteenth of the area 4 has this radius; nothing covers the square with less.
            let hexagon = (0.25f32 * 2.0 / (3.0 * 3f32.sqrt())).sqrt();
            assert!((0.95 * hexagon..1.5 * hexagon).contains(&largest(&clusters)), "{}", largest(&clusters));
        }
    }

    #[test]
    fn a_round_never_enlarges_the_largest_radius() {
        let points: Vec<DVec3> =
            builtin::shapes::torus(0.7, 0.3, 60, 20).positions.iter().map(|p| p.as_dvec3()).collect();
        let mut centers = spread_centers(&points, 12, 3);
        let mut before = f64::INFINITY;
        for _ in 0..15 {
            let spheres = members(&assign(&points, &centers), 12).into_iter().map(|own| {
                let own: Vec<DVec3> = own.iter().map(|&k| points[k as usize]).collect();
                bounding_sphere(&own)
            });
            let spheres: Vec<(DVec3, f64)> = spheres.collect();
            let now = spheres.iter().map(|b| b.1).fold(0.0, f64::max);
            assert!(now <= before * (1.0 + 1e-12), "{now} after {before}");
            centers = spheres.iter().map(|b| b.0).collect();
            before = now;
        }
    }

    #[test]
    fn few_and_equal_points_leave_no_cluster_empty() {
        assert_eq!(cluster(&[], 3, 0), Clusters::default());
        let same = [Vec3::new(1.0, 2.0, 3.0); 7];
        for count in 1..=7 {
            let clusters = cluster(&same, count, 0);
            check(&same, &clusters, count);
            assert_eq!(largest(&clusters), 0.0);
        }
        let positions = builtin::shapes::sphere(1).positions;
        check(&positions, &cluster(&positions, 12, 5), 12);
        check(&positions, &cluster(&positions, 99, 5), 12);
        check(&positions, &cluster(&positions, 0, 5), 1);
    }

    #[test]
    fn the_same_seed_gives_the_same_clusters_on_any_number_of_threads() {
        let positions = builtin::shapes::torus(0.7, 0.3, 40, 20).positions;
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let three = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let run = || cluster(&positions, 9, 4);
        assert_eq!(one.install(run), three.install(run));
        assert_ne!(run().assignment, cluster(&positions, 9, 5).assignment);
    }
}
