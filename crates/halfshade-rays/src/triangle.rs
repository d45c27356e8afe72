//! A ray and one triangle, in double precision.

use crate::ray::Ray;
use glam::DVec3;

/// Where a ray crosses a triangle.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Place of the triangle in the list that the hierarchy was built of.
    pub triangle: u32,
    /// Distance from the ray's origin; less than 0 at most by the ray's reach.
    pub distance: f64,
    /// Whether the ray leaves through the back of the triangle, from inside to outside.
    pub leaves: bool,
    /// The point, and the corners, from the ray's origin.
    point: DVec3,
    corners: [DVec3; 3],
    /// As long as twice the area.
    normal: DVec3,
}

impl Crossing {
    /// The same with a distance in another unit.
    #[inline(always)]
    pub(crate) fn with_distance(self, distance: f64) -> Self {
        Self { distance, ..self }
    }

    /// Weights of the triangle's vertices, not negative, of sum 1.
    pub fn weights(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        let (point, squared) = (self.point - a, self.normal.length_squared());
        let v = self.normal.dot(point.cross(c - a)) / squared;
        let w = self.normal.dot((b - a).cross(point)) / squared;
        let weights = DVec3::new(1.0 - v - w, v, w).max(DVec3::ZERO);
        weights / weights.element_sum()
    }
}

/// The axis after each.
const NEXT: [usize; 3] = [1, 2, 0];

/// The axes along which space is sheared so that a ray becomes the last one, and by how much.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shear {
    pub(crate) axes: [usize; 3],
    pub(crate) by: [f64; 2],
}

impl Shear {
    #[inline(always)]
    pub(crate) fn of(direction: DVec3) -> Self {
        // By numbers rather than branches, which nobody could predict.
        let size = direction.abs();
        let last = usize::from(size.x <= size.y.max(size.z)) * (1 + usize::from(size.y <= size.z));
        let axes = [NEXT[last], NEXT[NEXT[last]], last];
        let [x, y, z] = axes.map(|axis| direction[axis]);
        Self { axes, by: [x / z, y / z] }
    }
}

/// Where a ray crosses a triangle, if it does before its limit.
///
/// Space is sheared so that the ray becomes the third axis, and the signs of three edge functions of the sheared vertices
/// decide \[Woop2013\]. A sheared vertex depends on the vertex and the ray alone, the function of an edge is exactly the negative
/// of its neighbour's, and 0 counts as inside for both: no ray slips between two triangles that share an edge or a vertex.
pub(crate) fn crossing(corners: [DVec3; 3], triangle: u32, ray: &Ray, shear: &Shear) -> Option<Crossing> {
    let [a, b, c] = corners.map(|corner| corner - ray.origin);
    let normal = (b - a).cross(c - a);
    let (ahead, facing) = (normal.dot(a), normal.dot(ray.direction));
    let slack = normal.abs().dot(ray.slack);
    let is_met = if facing > 0.0 {
        ahead > slack
    } else {
        // A ray along a curved surface may have left again what it entered farther back.
        facing < 0.0 && ahead < slack && ahead < -facing * ray.reach
    };
    let [kx, ky, kz] = shear.axes;
    let sheared = |corner: DVec3| [corner[kx] - shear.by[0] * corner[kz], corner[ky] - shear.by[1] * corner[kz]];
    // Without fused multiply-add, so that both products are rounded alike.
    let edge = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let is_crossed = || {
        let [a, b, c] = [a, b, c].map(sheared);
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        edges.iter().all(|&edge| edge >= 0.0) || edges.iter().all(|&edge| edge <= 0.0)
    };
    if !(is_met && is_crossed()) {
        return None;
    }
    // The plane of a triangle seen edge-on may be crossed elsewhere, but no farther away than its vertices.
    let depths = DVec3::new(a[kz], b[kz], c[kz]) / ray.direction[kz];
    let distance = (ahead / facing).clamp(depths.min_element(), depths.max_element());
    let (point, corners) = (distance * ray.direction, [a, b, c]);
    (distance < ray.limit).then_some(Crossing { triangle, distance, leaves: facing > 0.0, point, corners, normal })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn random_point(rng: &mut Pcg64Mcg) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
    }

    fn cross(corners: [DVec3; 3], ray: &Ray) -> Option<Crossing> {
        crossing(corners, 0, ray, &Shear::of(ray.direction))
    }

    #[test]
    fn a_crossing_lies_on_the_ray_and_on_the_triangle() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut hits = 0;
        for _ in 0..20_000 {
            let corners = [(); 3].map(|()| random_point(&mut rng));
            let ray = Ray::new(3.0 * random_point(&mut rng), random_point(&mut rng).normalize());
            let Some(crossing) = cross(corners, &ray) else { continue };
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            if normal.dot(ray.direction).abs() < 1e-2 {
                continue;
            }
            hits += 1;
            let weights = crossing.weights();
            let on_triangle: DVec3 = corners.into_iter().zip(weights.to_array()).map(|(corner, w)| w * corner).sum();
            assert!((ray.origin + crossing.distance * ray.direction).distance(on_triangle) < 1e-12);
            assert!(weights.min_element() >= 0.0 && (weights.element_sum() - 1.0).abs() < 1e-12);
            assert_eq!(crossing.leaves, normal.dot(ray.direction) > 0.0);
        }
        assert!(hits > 100);
    }

    #[test]
    fn a_ray_that_leaves_a_surface_meets_only_the_face_that_it_starts_on() {
        let up = [DVec3::ZERO, DVec3::Z * 4.0, DVec3::X * 4.0];
        let mut rng = Pcg64Mcg::seed_from_u64(2);
        for _ in 0..1000 {
            let direction = random_point(&mut rng).normalize();
            let ray = Ray::new(DVec3::new(1.0, 0.0, 1.0), direction).leaving(DVec3::X, DVec3::splat(1e-3));
            assert_eq!(cross(up, &ray).is_some(), direction.y < 0.0, "{direction}");
        }
    }

    #[test]
    fn what_lies_behind_or_too_far_or_has_no_area_is_missed() {
        let corners = [DVec3::X, DVec3::Y, DVec3::new(-1.0, -1.0, 0.0)];
        let ray = |z: f64, d: f64| Ray::new(DVec3::new(0.0, 0.0, z), DVec3::new(0.0, 0.0, d));
        let distance = |corners, ray: Ray| cross(corners, &ray).map(|crossing| crossing.distance);
        assert_eq!(distance(corners, ray(-2.0, 1.0)), Some(2.0));
        assert_eq!(distance(corners, ray(2.0, -1.0)), Some(2.0));
        assert_eq!(distance(corners, ray(2.0, -1.0).until(2.0)), None);
        assert_eq!(distance(corners, ray(2.0, 1.0)), None);
        assert_eq!(distance([DVec3::X, DVec3::NEG_X, DVec3::ZERO], ray(-2.0, 1.0)), None);
        assert_eq!(distance([DVec3::ZERO; 3], ray(-2.0, 1.0)), None);
    }
}
