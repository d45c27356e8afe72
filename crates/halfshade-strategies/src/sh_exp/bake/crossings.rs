//! Where a ray crosses a mesh, all along.

use crate::shared::triangle_rays::{RaySpace, hierarchy};
use glam::{DVec3, Vec3, Vec3A};
use halfshade_scene::Mesh;
use obvhs::{
    cwbvh::CwBvh,
    ray::{Ray, RayHit},
    triangle::Triangle,
};
use std::sync::Arc;

/// How far outside a triangle, in barycentric weights, a crossing still counts: sample directions meet vertices exactly.
const EDGE: f64 = 1e-9;

/// The triangles of a mesh, in its own space, in a hierarchy.
pub(crate) struct Crossings {
    mesh: Arc<Mesh>,
    hierarchy: CwBvh,
    space: RaySpace,
}

impl std::fmt::Debug for Crossings {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Crossings").field("triangles", &self.mesh.triangles.len()).finish_non_exhaustive()
    }
}

/// One place where a ray meets the surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// From the ray's origin, in lengths of the mesh's space.
    pub(crate) distance: f64,
    pub(crate) triangle: usize,
    /// Weights of the triangle's vertices.
    pub(crate) weights: DVec3,
    /// Whether the ray leaves through the back of the triangle, from inside to outside.
    pub(crate) leaves: bool,
}

impl Crossings {
    pub(crate) fn new(mesh: &Arc<Mesh>) -> Self {
        let (low, high) = mesh.bounds().unwrap_or((Vec3::ZERO, Vec3::ZERO));
        let space = RaySpace::around(low, high);
        let corners: Vec<Triangle> = (mesh.triangles.iter())
            .map(|corners| {
                let [v0, v1, v2] = corners.map(|v| space.place(mesh.positions[v as usize].as_dvec3()));
                Triangle { v0, v1, v2 }
            })
            .collect();
        let hierarchy = hierarchy(&corners);
        Self { mesh: mesh.clone(), hierarchy, space }
    }

    /// Calls `each` for all crossings of the ray from `origin` along unit `direction`, in no particular order.
    ///
    /// At an edge both triangles may answer, and rarely none: the boxes' rays are in single precision.
    pub(crate) fn along(&self, origin: DVec3, direction: DVec3, mut each: impl FnMut(Crossing)) {
        if self.mesh.triangles.is_empty() {
            return;
        }
        self.hierarchy.ray_traverse_anyhit(self.ray(origin, direction), |_, slot| {
            if let Some(crossing) = self.crossing(slot, origin, direction) {
                each(crossing);
            }
        });
    }

    /// The first crossing along the ray.
    pub(crate) fn first(&self, origin: DVec3, direction: DVec3) -> Option<Crossing> {
        if self.mesh.triangles.is_empty() {
            return None;
        }
        let mut hit = RayHit::none();
        self.hierarchy
            .ray_traverse(self.ray(origin, direction), &mut hit, |_, slot| {
                let crossing = self.crossing(slot, origin, direction);
                crossing.map_or(f32::INFINITY, |crossing| self.space.length(crossing.distance))
            })
            .then(|| self.crossing(hit.primitive_id as usize, origin, direction))
            .flatten()
    }

    fn ray(&self, origin: DVec3, direction: DVec3) -> Ray {
        // Adding 0 turns -0, with which the wide nodes miss everything, into 0.
        let direction = direction.as_vec3a() + Vec3A::ZERO;
        Ray::new(self.space.place(origin), direction, 0.0, f32::INFINITY)
    }

    fn crossing(&self, slot: usize, origin: DVec3, direction: DVec3) -> Option<Crossing> {
        let triangle = self.hierarchy.primitive_indices[slot] as usize;
        let [a, b, c] = self.mesh.triangles[triangle].map(|v| self.mesh.positions[v as usize].as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let facing = normal.dot(direction);
        let offset = a - origin;
        let distance = normal.dot(offset) / facing;
        // Barycentric weights by Cramer's rule on origin + t·direction = a + v·ab + w·ac.
        let across = direction.cross(offset);
        let (v, w) = (-across.dot(ac) / facing, across.dot(ab) / facing);
        let weights = DVec3::new(1.0 - v - w, v, w);
        let is_met = distance > 0.0 && weights.min_element() >= -EDGE && !self.mesh.is_cut_out(triangle, weights);
        is_met.then_some(Crossing { distance, triangle, weights, leaves: facing > 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin::shapes;

    /// Rays in all directions cross the unit sphere once from its centre and twice from outside, where it is.
    #[test]
    fn a_sphere_is_crossed_where_it_is() {
        for scale in [1e-3f32, 1.0, 1e3] {
            let mut mesh = shapes::sphere(12);
            mesh.positions.iter_mut().for_each(|p| *p *= scale);
            let mesh = Arc::new(mesh);
            let crossings = Crossings::new(&mesh);
            let scale = f64::from(scale);
            let mut lost = 0;
            for i in 0..500 {
                let z = -1.0 + 2.0 * (f64::from(i) + 0.5) / 500.0;
                let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
                let direction = DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
                let mut found = Vec::new();
                crossings.along(DVec3::ZERO, direction, |crossing| found.push(crossing));
                lost += usize::from(found.len() != 1);
                for crossing in found {
                    assert!(crossing.leaves && (crossing.distance / scale - 1.0).abs() < 0.01, "{crossing:?}");
                    let corners = mesh.triangles[crossing.triangle].map(|v| mesh.positions[v as usize].as_dvec3());
                    let point: DVec3 = corners.into_iter().zip(crossing.weights.to_array()).map(|(p, w)| w * p).sum();
                    assert!(point.distance(crossing.distance * direction) < 1e-9 * scale, "{crossing:?}");
                }
                let first = crossings.first(-3.0 * scale * direction, direction);
                lost += usize::from(first.is_none_or(|first| first.leaves || first.distance > 2.1 * scale));
                let mut sides = Vec::new();
                crossings.along(-3.0 * scale * direction, direction, |crossing| sides.push(crossing.leaves));
                sides.sort_unstable();
                lost += usize::from(sides != [false, true]);
            }
            assert!(lost <= 4, "{lost}");
        }
        Crossings::new(&Arc::default()).along(DVec3::ZERO, DVec3::X, |_| panic!("nothing to cross"));
        assert!(Crossings::new(&Arc::default()).first(DVec3::ZERO, DVec3::X).is_none());
    }
}
