//! Bounding of a triangle mesh by spheres: decided on the triangles, not on samples.
//!
//! A sphere is convex, so that a triangle whose corners lie in one sphere lies in it wholly. A triangle that lies in no
//! single sphere is cut in two at the middle of its longest edge, until that edge is below a tolerance; such a leaf
//! counts as covered only if one sphere holds it wholly. The answer errs on the safe side: a set that is said to bound
//! does; a violation is overestimated by at most the tolerance.

use super::DSphere;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell;
use std::ops::ControlFlow;

type Triangle = [DVec3; 3];

/// So many spheres are tried faster than sorted out.
const FEW: usize = 6;

/// An upper bound of the distance by which the triangles reach outside every sphere; 0 if the spheres bound them. Exceeds
/// the true distance by at most `tolerance`.
pub(super) fn violation(triangles: &[Triangle], spheres: &[DSphere], tolerance: f64) -> f64 {
    let least = |part: &Triangle, spheres: &[DSphere]| {
        spheres.iter().map(|sphere| sphere.missing(part)).fold(f64::INFINITY, f64::min)
    };
    // Corners tell how far the triangles reach at least. Beyond that little is left to be cut, also of a set that leaves
    // much bare. Maxima do not depend on the order, so that threads change no bit.
    let of_corners =
        |triangle: &Triangle| triangle.map(|corner| least(&[corner; 3], spheres)).into_iter().fold(0.0, f64::max);
    let known = triangles.par_iter().map(of_corners).reduce(|| 0.0, f64::max);
    let grown: Vec<DSphere> = spheres.iter().map(|s| DSphere { radius: s.radius + known, ..*s }).collect();
    let beyond = |triangle: &Triangle| {
        let mut largest = 0.0f64;
        each_leaf(triangle, &|k| grown[k], candidates(triangle, &grown), tolerance, |leaf, near| {
            let missing = near.iter().map(|&k| grown[k as usize].missing(leaf)).fold(f64::INFINITY, f64::min);
            largest = largest.max(missing);
        });
        largest
    };
    known + triangles.par_iter().map(beyond).reduce(|| 0.0, f64::max)
}

/// Corners of the pieces of triangles, no longer than `tolerance`, that no single sphere holds and that stick out.
pub(super) fn uncovered_points(triangles: &[Triangle], spheres: &[DSphere], tolerance: f64) -> Vec<DVec3> {
    let of_triangle = |triangle: &Triangle| {
        let mut points = Vec::new();
        each_leaf(triangle, &|k| spheres[k], candidates(triangle, spheres), tolerance, |leaf, near| {
            points.extend(leaf.iter().filter(|p| !near.iter().any(|&k| spheres[k as usize].contains(**p))));
        });
        points
    };
    let mut points: Vec<DVec3> = triangles.par_iter().map(of_triangle).flatten_iter().collect();
    sort_and_dedup(&mut points);
    points
}

/// Each point once, in an order that depends on the points alone.
pub(super) fn sort_and_dedup(points: &mut Vec<DVec3>) {
    let key = |p: &DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    points.sort_unstable_by_key(key);
    points.dedup_by_key(|p| key(p));
}

/// Grows radii until the spheres bound the triangles, each uncovered leaf by the sphere that needs to grow least, so
/// that no sphere grows by more than the violation before. `round_up` makes a radius representable. Returns the largest
/// growth.
pub(super) fn grow_to_cover(
    triangles: &[Triangle],
    spheres: &mut [DSphere],
    tolerance: f64,
    round_up: impl Fn(f64) -> f64,
) -> f64 {
    let before: Vec<f64> = spheres.iter().map(|sphere| sphere.radius).collect();
    let fixed = &*spheres;
    let open: Vec<&Triangle> = triangles.par_iter().filter(|triangle| is_open(triangle, fixed, tolerance)).collect();
    for triangle in open {
        let near = candidates(triangle, spheres);
        // Cells, since what has grown for one leaf holds whole pieces after it, which are then not cut into leaves.
        let spheres = Cell::from_mut(&mut *spheres).as_slice_of_cells();
        each_leaf(triangle, &|k| spheres[k].get(), near, tolerance, |leaf, _| {
            grow_to_hold(leaf, spheres, &before, &round_up);
        });
    }
    spheres.iter().zip(before).map(|(sphere, before)| sphere.radius - before).fold(0.0, f64::max)
}

/// Grows the sphere that needs to grow least, until it holds the leaf; none if one holds it already.
fn grow_to_hold(leaf: &Triangle, spheres: &[Cell<DSphere>], before: &[f64], round_up: &impl Fn(f64) -> f64) {
    let missing = |k: usize| spheres[k].get().missing(leaf);
    if (0..spheres.len()).any(|k| missing(k) <= 0.0) {
        return;
    }
    // Judged by the radii before: a sphere that has just grown would look nearest to every next leaf and creep.
    let need = |k: usize| missing(k) + (spheres[k].get().radius - before[k]);
    let Some(nearest) = (0..spheres.len()).min_by(|&a, &b| need(a).total_cmp(&need(b))) else { return };
    // More than once only where the sum is an ulp short.
    while missing(nearest) > 0.0 {
        let DSphere { center, radius } = spheres[nearest].get();
        let radius = round_up((radius + missing(nearest)).max(radius * (1.0 + f64::EPSILON)));
        spheres[nearest].set(DSphere { center, radius });
    }
}

impl DSphere {
    /// Growth of the radius that holds all three corners.
    fn missing(&self, triangle: &Triangle) -> f64 {
        let farthest = triangle.map(|corner| corner.distance_squared(self.center)).into_iter().fold(0.0, f64::max);
        farthest.sqrt() - self.radius
    }
}

/// Spheres that may touch the triangle; all of them if none does, so that a violation has something to be measured to.
fn candidates(triangle: &Triangle, spheres: &[DSphere]) -> Vec<u32> {
    let middle = triangle.iter().sum::<DVec3>() / 3.0;
    let reach = triangle.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
    let near = |k: &u32| {
        let sphere = &spheres[*k as usize];
        sphere.center.distance_squared(middle) <= (sphere.radius + reach).powi(2)
    };
    let all = 0..spheres.len() as u32;
    let found: Vec<u32> = all.clone().filter(near).collect();
    if found.is_empty() { all.collect() } else { found }
}

/// Whether a leaf of the triangle lies in no single sphere.
fn is_open(triangle: &Triangle, spheres: &[DSphere], tolerance: f64) -> bool {
    let first = &mut |_: &Triangle, _: &[u32]| ControlFlow::Break(());
    leaves(*triangle, &|k| spheres[k], &mut candidates(triangle, spheres), 0, tolerance, first).is_break()
}

/// Calls `visit` with every leaf that no single sphere holds, and those of `near` that may be the nearest to it.
fn each_leaf(
    triangle: &Triangle,
    sphere: &impl Fn(usize) -> DSphere,
    mut near: Vec<u32>,
    tolerance: f64,
    mut visit: impl FnMut(&Triangle, &[u32]),
) {
    let _ = leaves(*triangle, sphere, &mut near, 0, tolerance, &mut |leaf, near| {
        visit(leaf, near);
        ControlFlow::Continue(())
    });
}

/// Calls `visit` with every leaf that no single sphere holds, and the spheres that may be the nearest to it, until it
/// breaks.
///
/// `near` holds spheres for the triangle from `begin` on, and is as before on return up to their order.
fn leaves(
    triangle: Triangle,
    sphere: &impl Fn(usize) -> DSphere,
    near: &mut Vec<u32>,
    begin: usize,
    tolerance: f64,
    visit: &mut impl FnMut(&Triangle, &[u32]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    if let Some(place) = near[begin..].iter().position(|&k| sphere(k as usize).missing(&triangle) <= 0.0) {
        // The sphere that held the last piece probably holds the next.
        near.swap(begin, begin + place);
        return ControlFlow::Continue(());
    }
    // Turned so that the longest edge is ab. Halving that one alone cuts slivers across and leaves them few pieces.
    let edge_squared = |k: usize| triangle[k].distance_squared(triangle[(k + 1) % 3]);
    let longest = (1..3).fold(0, |longest, k| if edge_squared(k) > edge_squared(longest) { k } else { longest });
    if edge_squared(longest) <= tolerance * tolerance {
        return visit(&triangle, &near[begin..]);
    }
    let [a, b, c] = [0, 1, 2].map(|k| triangle[(longest + k) % 3]);
    let middle = a.midpoint(b);
    let end = near.len();
    keep_near(&triangle, sphere, near, begin);
    let flow = [[a, middle, c], [middle, b, c]]
        .into_iter()
        .try_for_each(|half| leaves(half, sphere, near, end, tolerance, visit));
    near.truncate(end);
    flow
}

/// Appends those of `near[begin..]` that may hold a part of the triangle, or be the nearest to one.
///
/// With middle m and reach ρ, what a sphere lacks of a part lies between |m − centre| − ρ − radius and, of the whole,
/// |m − centre| + ρ − radius. A sphere that lacks more of every part than another one of the whole decides nothing: a large
/// triangle meets all spheres of a set, its pieces few.
fn keep_near(triangle: &Triangle, sphere: &impl Fn(usize) -> DSphere, near: &mut Vec<u32>, begin: usize) {
    let end = near.len();
    if end - begin <= FEW {
        near.extend_from_within(begin..end);
        return;
    }
    let middle = triangle.iter().sum::<DVec3>() / 3.0;
    let reach = triangle.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
    let gap = |k: u32| middle.distance(sphere(k as usize).center) - sphere(k as usize).radius;
    // A hair more than needed: rounding must not decide.
    let limit = near[begin..].iter().map(|&k| gap(k)).fold(f64::INFINITY, f64::min) + 2.0 * (1.0 + 1e-9) * reach;
    for place in begin..end {
        if gap(near[place]) <= limit {
            near.push(near[place]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two spheres hold the ends of a long triangle; the middle sticks out by a known amount.
    #[test]
    fn finds_what_no_vertex_shows() {
        let triangle = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.0, 1e-9, 0.0)];
        let mut spheres = [-1.0, 1.0].map(|x| DSphere { center: DVec3::new(x, 0.0, 0.0), radius: 0.9 });
        let found = violation(&[triangle], &spheres, 1e-4);
        assert!((0.1 - 1e-12..0.1 + 1e-4).contains(&found), "the middle lies 1 away from both: {found}");
        // Known from the corners already, and only the middle beyond them.
        let far = spheres.map(|sphere| DSphere { radius: 0.3, center: 0.5 * sphere.center });
        let found = violation(&[triangle], &far, 1e-4);
        assert!((0.2..0.2 + 1e-4).contains(&found), "the ends lie 0.5 away from a centre: {found}");
        let growth = grow_to_cover(&[triangle], &mut spheres, 1e-4, |r| r);
        assert!(growth < 0.1 + 1e-3 && violation(&[triangle], &spheres, 1e-4) == 0.0, "{growth}");
        assert!(!uncovered_points(&[triangle], &spheres.map(|b| DSphere { radius: 0.9, ..b }), 1e-2).is_empty());
    }
}
