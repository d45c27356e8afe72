//! Triangles in a wide bounding-volume hierarchy, for rays that ask whether anything is in the way.

use glam::{DVec3, Vec3, Vec3A};
use halfshade_scene::Mesh;
use obvhs::{
    Boundable, BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::Ray,
    rt_triangle::RtTriangle,
};
use std::sync::Arc;
use std::time::Duration;

/// Half the largest extent in the space that rays are traced in. obvhs ignores hits nearer than 1e-4, whatever the
/// size: here that is two units in the last place.
pub(crate) const HALF_EXTENT: f32 = 512.0;

/// The hierarchy over primitives, of which there may be none.
pub(crate) fn hierarchy<T: Boundable>(primitives: &[T]) -> CwBvh {
    if primitives.is_empty() {
        return CwBvh::default();
    }
    build_cwbvh(primitives, BvhBuildParams::medium_build(), &mut Duration::default())
}

/// A triangle of a mesh, by number, in which a mask cuts holes; without one it is whole.
pub(crate) type Holes = Option<(Arc<Mesh>, u32)>;

/// What holes each triangle of a mesh has.
pub(crate) fn holes_of(mesh: &Arc<Mesh>) -> impl Iterator<Item = Holes> {
    (0..mesh.triangles.len()).map(move |triangle| mesh.mask_of(triangle).map(|_| (mesh.clone(), triangle as u32)))
}

/// Triangles, centred and scaled.
///
/// Not watertight: a ray aimed exactly at an edge may pass. Both faces of a triangle block.
pub(crate) struct TriangleRays {
    hierarchy: CwBvh,
    /// In the order of the hierarchy's leaves.
    triangles: Vec<RtTriangle>,
    /// In the same order; empty where all triangles are whole.
    holes: Vec<Holes>,
    center: Vec3,
    scale: f32,
    /// How much coordinates of the corners may be rounded, in units of the traced space.
    coarseness: f32,
}

impl TriangleRays {
    /// Of the triangles with these corners; what is not finite is left out. `holes` has an entry for each, or none at all
    /// where all are whole.
    pub(crate) fn new(mut corners: Vec<[Vec3; 3]>, mut holes: Vec<Holes>) -> Self {
        let is_finite = |points: &[Vec3; 3]| points.iter().all(|point| point.is_finite());
        let mut is_kept = corners.iter().map(is_finite).collect::<Vec<_>>().into_iter();
        holes.retain(|_| is_kept.next().unwrap_or(false));
        corners.retain(is_finite);
        let low = corners.iter().flatten().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = corners.iter().flatten().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let center = low + 0.5 * (high - low);
        let half = 0.5 * (high - low).max_element();
        let scale = if half > 0.0 { (HALF_EXTENT / half).min(f32::MAX.sqrt()) } else { 1.0 };
        let place = |point: Vec3| Vec3A::from((point - center) * scale);
        let triangles: Vec<RtTriangle> =
            corners.iter().map(|&[a, b, c]| RtTriangle::new(place(a), place(b), place(c))).collect();
        let hierarchy = hierarchy(&triangles);
        let triangles = hierarchy.primitive_indices.iter().map(|&slot| triangles[slot as usize]).collect();
        let holes = match holes.as_slice() {
            [] => Vec::new(),
            list => hierarchy.primitive_indices.iter().map(|&slot| list[slot as usize].clone()).collect(),
        };
        let coarseness = low.abs().max(high.abs()).max_element() * f32::EPSILON * scale;
        Self { hierarchy, triangles, holes, center, scale, coarseness }
    }

    /// How far, in units of the traced space, a point may be off because coordinates far from the origin are coarse.
    pub(crate) fn coarseness(&self) -> f32 {
        self.coarseness
    }

    /// Whether a triangle lies on the ray within `distance`, which may be infinite. The ray starts at `position`, moved by
    /// `lift` in the traced space, of which the triangles fill 1024 units. `direction` has unit length.
    pub(crate) fn blocked(&self, position: Vec3, lift: Vec3, direction: Vec3, distance: f32) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let origin = Vec3A::from((position - self.center) * self.scale + lift);
        let limit = distance * self.scale;
        if !origin.is_finite() || !direction.is_finite() || limit.is_nan() {
            return false;
        }
        // -0.0 would make the hierarchy miss everything.
        let ray = Ray::new(origin, Vec3A::from(direction) + 0.0, 0.0, limit);
        if self.holes.is_empty() {
            return !self.hierarchy.ray_traverse_miss(ray, |ray, slot| self.triangles[slot].intersect(ray));
        }
        !self.hierarchy.ray_traverse_miss(ray, |ray, slot| {
            let distance = self.triangles[slot].intersect(ray);
            if distance.is_finite() && self.passes(ray, slot) { f32::INFINITY } else { distance }
        })
    }

    /// Whether a ray that meets a triangle passes through a hole of it.
    fn passes(&self, ray: &Ray, slot: usize) -> bool {
        let Some((mesh, triangle)) = &self.holes[slot] else { return false };
        let [v, w] = self.triangles[slot].compute_barycentric(ray).as_dvec2().to_array();
        mesh.is_cut_out(*triangle as usize, DVec3::new(1.0 - v - w, v, w))
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.holes.as_slice())
            + size_of_val(self.hierarchy.nodes.as_slice())
            + size_of_val(self.hierarchy.primitive_indices.as_slice())
    }
}
