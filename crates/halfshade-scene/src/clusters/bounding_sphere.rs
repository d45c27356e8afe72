//! The smallest sphere around points.

use glam::{DMat3, DVec3};

/// Excess of a point over the squared radius, as a fraction of it, that counts as inside: above rounding, which
/// would otherwise keep the iteration going among points of one sphere.
const TOLERANCE: f64 = 1e-13;

/// The centre and radius of the smallest sphere that contains all `points` (finite); radius 0 for one point or none.
///
/// The move-to-front recursion of \[Welzl1991\] on a short list of candidates, to which the point farthest outside is
/// added until none is outside (the pivoting of \[Gaertner1999\]). The centre is that of the exact smallest sphere up
/// to rounding, and the radius is the distance of the farthest point from it, so that rounding leaves no point outside.
/// A few passes over the points, whatever their order.
pub fn bounding_sphere(points: &[DVec3]) -> (DVec3, f64) {
    let Some(&first) = points.first() else { return (DVec3::ZERO, 0.0) };
    let mut candidates = vec![first];
    let mut sphere = BoundingSphere { center: first, radius_squared: 0.0 };
    loop {
        let (farthest, squared) = farthest_from(points, sphere.center);
        if !sphere.excludes_squared(squared) || candidates.contains(&farthest) {
            return (sphere.center, squared.sqrt());
        }
        candidates.insert(0, farthest);
        let count = candidates.len();
        let grown = welzl(&mut candidates, count, &mut Vec::with_capacity(4));
        if grown.radius_squared <= sphere.radius_squared {
            // Only rounding can keep the sphere from growing when a point outside is added.
            return (sphere.center, squared.sqrt());
        }
        sphere = grown;
    }
}

fn farthest_from(points: &[DVec3], center: DVec3) -> (DVec3, f64) {
    points.iter().fold((center, 0.0), |best, &point| {
        let squared = point.distance_squared(center);
        if squared > best.1 { (point, squared) } else { best }
    })
}

#[derive(Debug, Clone, Copy)]
struct BoundingSphere {
    center: DVec3,
    radius_squared: f64,
}

impl BoundingSphere {
    fn excludes_squared(&self, distance_squared: f64) -> bool {
        distance_squared > self.radius_squared * (1.0 + TOLERANCE)
    }
}

/// The smallest sphere around `points[..end]` with all of `on_surface` on its surface; points that mattered move to the
/// front.
fn welzl(points: &mut [DVec3], end: usize, on_surface: &mut Vec<DVec3>) -> BoundingSphere {
    let mut sphere = circumscribed(on_surface).unwrap_or(BoundingSphere { center: DVec3::ZERO, radius_squared: -1.0 });
    if on_surface.len() == 4 {
        return sphere;
    }
    for i in 0..end {
        let point = points[i];
        if !sphere.excludes_squared(point.distance_squared(sphere.center)) {
            continue;
        }
        on_surface.push(point);
        // Points that lie in one line or plane with the others, up to rounding, have no sphere through them.
        if circumscribed(on_surface).is_some() {
            sphere = welzl(points, i, on_surface);
            points[..=i].rotate_right(1);
        }
        on_surface.pop();
    }
    sphere
}

/// The sphere with up to four points on its surface and its centre in their affine hull; `None` where there is none.
fn circumscribed(points: &[DVec3]) -> Option<BoundingSphere> {
    let (&origin, rest) = points.split_first()?;
    let edge = |i: usize| rest.get(i).map(|&p| p - origin);
    // The centre c from the origin solves 2 c·e = e·e for each edge e. Missing edges are replaced by directions
    // perpendicular to all others, along which the centre doesn't move.
    let c = match (edge(0), edge(1), edge(2)) {
        (None, ..) => DVec3::ZERO,
        (Some(a), None, _) => 0.5 * a,
        (Some(a), Some(b), third) => {
            let normal = a.cross(b);
            let (last, last_squared) = match third {
                Some(third) => (third, third.length_squared()),
                None => (normal, 0.0),
            };
            let rows = DMat3::from_cols(a, b, last).transpose();
            let scale = a.length() * b.length() * last.length();
            if rows.determinant().abs() <= 1e-12 * scale || normal.length() <= 1e-12 * a.length() * b.length() {
                return None;
            }
            rows.inverse() * (0.5 * DVec3::new(a.length_squared(), b.length_squared(), last_squared))
        }
    };
    // The mean of the squared distances: no point is preferred.
    let center = origin + c;
    let sum: f64 = points.iter().map(|p| p.distance_squared(center)).sum();
    Some(BoundingSphere { center, radius_squared: sum / points.len() as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// The smallest of all spheres through 2, 3 or 4 of the points that contain the rest.
    fn by_exhaustion(points: &[DVec3]) -> f64 {
        let n = points.len();
        let mut best = f64::INFINITY;
        let mut consider = |chosen: &[DVec3]| {
            if let Some(sphere) = circumscribed(chosen)
                && points.iter().all(|p| p.distance_squared(sphere.center) <= sphere.radius_squared * (1.0 + 1e-9))
            {
                best = best.min(sphere.radius_squared.sqrt());
            }
        };
        for i in 0..n {
            for j in 0..i {
                consider(&[points[i], points[j]]);
                for k in 0..j {
                    consider(&[points[i], points[j], points[k]]);
                    for l in 0..k {
                        consider(&[points[i], points[j], points[k], points[l]]);
                    }
                }
            }
        }
        best
    }

    #[test]
    fn agrees_with_exhaustion() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        for round in 0..300 {
            let count = 2 + round % 9;
            // Flat and needle-shaped sets too.
            let stretch = [DVec3::ONE, DVec3::new(1.0, 1.0, 1e-3), DVec3::new(1.0, 1e-4, 1e-4)][round / 9 % 3];
            let points: Vec<DVec3> = (0..count)
                .map(|_| stretch * DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0))))
                .collect();
            let (center, radius) = bounding_sphere(&points);
            let exact = by_exhaustion(&points);
            assert!((radius / exact - 1.0).abs() < 1e-8, "{radius} instead of {exact}: {points:?}");
            assert!(points.iter().all(|p| p.distance(center) <= radius * (1.0 + 1e-15)));
        }
    }

    #[test]
    fn closed_forms() {
        let cube: Vec<DVec3> =
            (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
        let (center, radius) = bounding_sphere(&cube);
        assert!(center.distance(DVec3::splat(0.5)) < 1e-14 && (radius - 0.75f64.sqrt()).abs() < 1e-14);
        // A flat obtuse triangle: its longest side is the diameter.
        let (center, radius) = bounding_sphere(&[DVec3::NEG_X, DVec3::new(0.1, 0.2, 0.0), DVec3::X]);
        assert_eq!((center, radius), (DVec3::ZERO, 1.0));
        assert_eq!(bounding_sphere(&[]), (DVec3::ZERO, 0.0));
        assert_eq!(bounding_sphere(&[DVec3::ONE; 5]), (DVec3::ONE, 0.0));
        let line: Vec<DVec3> = (0..50).map(|i| DVec3::new(1.0, 2.0, 3.0) * f64::from(i * 7 % 50)).collect();
        assert!((bounding_sphere(&line).1 - 24.5 * 14f64.sqrt()).abs() < 1e-11);
    }

    #[test]
    fn points_of_one_sphere_far_from_the_origin() {
        let away = DVec3::new(1e4, -2e4, 3e4);
        let points: Vec<DVec3> =
            crate::builtin::shapes::sphere(12).positions.iter().map(|p| p.as_dvec3().normalize() + away).collect();
        let (center, radius) = bounding_sphere(&points);
        assert!(center.distance(away) < 1e-9 && (radius - 1.0).abs() < 1e-9, "{center} {radius}");
    }
}
