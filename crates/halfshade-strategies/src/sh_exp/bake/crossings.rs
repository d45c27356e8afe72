//! Where a ray crosses a mesh, all along.

use glam::DVec3;
use halfshade_rays::{MeshRays, Ray};
use halfshade_scene::Mesh;
use std::sync::Arc;

/// The triangles of a mesh, in its own space, in a hierarchy.
pub(crate) struct Crossings {
    mesh: Arc<Mesh>,
    rays: MeshRays,
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
        Self { mesh: mesh.clone(), rays: MeshRays::new(&mesh.positions, &mesh.triangles) }
    }

    /// Calls `each` for all crossings of the ray from `origin` along unit `direction`, in no particular order. At an edge both
    /// triangles answer.
    pub(crate) fn along(&self, origin: DVec3, direction: DVec3, mut each: impl FnMut(Crossing)) {
        self.rays.any(&Ray::new(origin, direction), |crossing| {
            if let Some(crossing) = self.of_surface(crossing) {
                each(crossing);
            }
            false
        });
    }

    /// The first crossing along the ray.
    pub(crate) fn first(&self, origin: DVec3, direction: DVec3) -> Option<Crossing> {
        let ray = Ray::new(origin, direction);
        self.rays
            .closest(&ray, |crossing| self.of_surface(crossing).is_some())
            .and_then(|found| self.of_surface(&found))
    }

    /// A crossing, unless it lies in a hole.
    fn of_surface(&self, crossing: &halfshade_rays::Crossing) -> Option<Crossing> {
        let (triangle, weights) = (crossing.triangle as usize, crossing.weights());
        let &halfshade_rays::Crossing { distance, leaves, .. } = crossing;
        (!self.mesh.is_cut_out(triangle, weights)).then_some(Crossing { distance, triangle, weights, leaves })
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
            // At an edge both triangles answer.
            assert!(lost <= 4, "{lost}");
        }
        Crossings::new(&Arc::default()).along(DVec3::ZERO, DVec3::X, |_| panic!("nothing to cross"));
        assert!(Crossings::new(&Arc::default()).first(DVec3::ZERO, DVec3::X).is_none());
    }
}
