//! The points that stand for an object while its spheres are fitted: evenly spread surface points and inner points.

use super::DSphere;
use super::solid::Columns;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Candidates drawn per surface point kept.
const CANDIDATES_PER_POINT: usize = 4;

/// `count` points spread evenly over the surface: candidates drawn by area, then farthest-point selection, which leaves
/// distances between neighbours as equal as repulsion would and needs no geodesics.
pub(super) fn surface_points(corners: &[[DVec3; 3]], count: usize, rng: &mut Pcg64Mcg) -> Vec<DVec3> {
    let candidates = drawn_by_area(corners, count * CANDIDATES_PER_POINT, rng);
    if candidates.is_empty() {
        return corners.iter().map(|triangle| triangle[0]).take(count.max(1)).collect();
    }
    let candidates: Vec<DVec3> = candidates.into_iter().map(|(_, point)| point).collect();
    farthest_points(&candidates, count)
}

/// `count` points of the surface drawn by area with the R2 sequence, each with its triangle; none if there is no area.
pub(super) fn drawn_by_area(corners: &[[DVec3; 3]], count: usize, rng: &mut Pcg64Mcg) -> Vec<(usize, DVec3)> {
    let mut total = 0.0;
    let cumulative: Vec<f64> = corners
        .iter()
        .map(|[a, b, c]| {
            total += 0.5 * (b - a).cross(c - a).length();
            total
        })
        .collect();
    if total <= 0.0 {
        return Vec::new();
    }
    let shift: [f64; 2] = [rng.random(), rng.random()];
    (0..count)
        .map(|k| {
            let area = (k as f64 + rng.random::<f64>()) / count as f64 * total;
            let triangle = cumulative.partition_point(|&sum| sum < area).min(corners.len() - 1);
            let [a, b, c] = corners[triangle];
            // The R2 sequence: multiples of the inverse plastic number and of its square.
            let u = (shift[0] + k as f64 * 0.754_877_666_246_692_7).fract();
            let v = (shift[1] + k as f64 * 0.569_840_290_998_053_2).fract();
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            (triangle, a + u * (b - a) + v * (c - a))
        })
        .collect()
}

/// `count` of the points, each as far as possible from those before it.
pub(super) fn farthest_points(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let Some(&start) = points.first() else { return Vec::new() };
    let mut chosen = vec![start];
    let mut distance: Vec<f64> = points.iter().map(|p| p.distance_squared(start)).collect();
    while chosen.len() < count.min(points.len()) {
        let (mut farthest, mut largest) = (0, -1.0);
        for (k, &d) in distance.iter().enumerate() {
            if d > largest {
                (farthest, largest) = (k, d);
            }
        }
        if largest <= 0.0 {
            break;
        }
        let next = points[farthest];
        chosen.push(next);
        for (d, p) in distance.iter_mut().zip(points) {
            *d = d.min(p.distance_squared(next));
        }
    }
    chosen
}

/// About `count` points of a regular grid that lie inside the solid; fewer if it is thin, none if it is empty.
pub(super) fn inner_points(solid: &Columns, bounds: [DVec3; 2], count: usize) -> Vec<DVec3> {
    let volume = solid.volume();
    if volume <= 0.0 || count == 0 {
        return Vec::new();
    }
    let step = (volume / count as f64).cbrt();
    let cells = ((bounds[1] - bounds[0]) / step).ceil().max(DVec3::ONE);
    let origin = 0.5 * (bounds[0] + bounds[1]) - 0.5 * (cells - 1.0) * step;
    let mut points = Vec::new();
    for k in 0..cells.z as usize {
        for j in 0..cells.y as usize {
            for i in 0..cells.x as usize {
                let point = origin + step * DVec3::new(i as f64, j as f64, k as f64);
                if solid.contains(point) {
                    points.push(point);
                }
            }
        }
    }
    points
}

/// The `neighbors` nearest other points of each point, made symmetric: the graph that the flood fill walks.
pub(super) fn neighbor_graph(points: &[DVec3], neighbors: usize) -> Vec<Vec<u32>> {
    use rayon::prelude::*;
    let nearest: Vec<Vec<u32>> = points
        .par_iter()
        .enumerate()
        .map(|(k, p)| {
            let mut others: Vec<(f64, u32)> = points
                .iter()
                .enumerate()
                .filter(|&(other, _)| other != k)
                .map(|(other, q)| (p.distance_squared(*q), other as u32))
                .collect();
            let kept = neighbors.min(others.len());
            if kept < others.len() {
                others.select_nth_unstable_by(kept, |a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
                others.truncate(kept);
            }
            others.iter().map(|&(_, other)| other).collect()
        })
        .collect();
    let mut graph = nearest.clone();
    for (k, near) in nearest.iter().enumerate() {
        for &other in near {
            graph[other as usize].push(k as u32);
        }
    }
    for near in &mut graph {
        near.sort_unstable();
        near.dedup();
    }
    graph
}

/// The smallest radius about `center` that covers all `points`.
pub(super) fn covering_radius<'a>(center: DVec3, points: impl Iterator<Item = &'a DVec3>) -> f64 {
    points.map(|p| p.distance_squared(center)).fold(0.0, f64::max).sqrt()
}

/// A sphere about the points' mean that covers them all.
pub(super) fn mean_centered_sphere(points: &[DVec3]) -> DSphere {
    let center = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    DSphere { center, radius: covering_radius(center, points.iter()) }
}
