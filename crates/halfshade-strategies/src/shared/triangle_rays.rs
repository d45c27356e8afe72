//! Triangles in a wide bounding-volume hierarchy, for rays that ask whether anything is in the way.

use super::origin::origin_between;
use glam::{DVec3, Vec3, Vec3A};
use halfshade_scene::Mesh;
use obvhs::{
    Boundable, BvhBuildParams,
    aabb::Aabb,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::Ray,
};
use std::{sync::Arc, time::Duration};

/// Half the largest extent in the space that rays are traced in, at most. obvhs ignores what is nearer than 1e-4, whatever
/// the size: here that is 1e-13 of the half extent.
const HALF_EXTENT: f64 = (1_u64 << 30) as f64;

/// The start of a ray in obvhs: a box that ends before is not entered, so boxes are that much larger.
const NEAREST: f32 = 1e-4;

/// How far a coordinate may be off the surface that it stands for, as a part of itself: rounding of the point, and of the
/// ray's origin, with room.
pub(crate) const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// The rounding added to that, in the space of rays: 2^-46 of half the extent.
const LEAST_ROUNDING: f32 = (HALF_EXTENT / (1_u64 << 46) as f64) as f32;

/// How far behind its origin a ray meets what faces it, in lengths of its slack.
const REACH_BEHIND: f32 = 4.0;

/// How much rounding may change the volume that a ray spans with an edge, as a part of the product of the edge's length and
/// its distance, with room.
const VOLUME_ROUNDING: f32 = 16.0 * f32::EPSILON;

/// The least half extent of what is traced, as a part of how far out it lies: boxes that are flat along the axes on which
/// they lie far out may be smaller by any factor, and what is added for rounding would overflow. 2^-32.
const LEAST_EXTENT: f64 = 1.0 / (1_u64 << 32) as f64;

/// The least half extent of all: 2^-92, so that scales fit single precision.
const SMALLEST_EXTENT: f64 = 1.0 / (1_u128 << 92) as f64;

/// The hierarchy over primitives, of which there may be none.
pub(crate) fn hierarchy<T: Boundable>(primitives: &[T]) -> CwBvh {
    if primitives.is_empty() {
        return CwBvh::default();
    }
    build_cwbvh(primitives, BvhBuildParams::medium_build(), &mut Duration::default())
}

/// A triangle of a mesh, by number, in which a mask cuts holes; without one it is whole.
pub(crate) type Holes = Option<(Arc<Mesh>, u32)>;

/// The holes of each triangle of a mesh.
pub(crate) fn holes_of(mesh: &Arc<Mesh>) -> impl Iterator<Item = Holes> {
    (0..mesh.triangles.len()).map(move |triangle| mesh.mask_of(triangle).map(|_| (mesh.clone(), triangle as u32)))
}

/// The space that rays are traced in: scaled by a power of two, and recentred where that costs no digit, so that single
/// precision means the same there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RaySpace {
    center: DVec3,
    scale: f64,
}

impl RaySpace {
    /// For what lies between two corners.
    pub(crate) fn around(low: Vec3, high: Vec3) -> Self {
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let farthest = low.abs().max(high.abs()).max_element();
        let largest = (0.5 * (high - low).max_element()).max(LEAST_EXTENT * farthest).max(SMALLEST_EXTENT);
        let scale = (HALF_EXTENT / largest).log2().floor().exp2();
        Self { center: origin_between(low, high), scale }
    }

    /// A point, placed.
    pub(crate) fn place(&self, point: DVec3) -> Vec3A {
        ((point - self.center) * self.scale).as_vec3a()
    }

    /// A length, scaled.
    pub(crate) fn length(&self, length: f64) -> f32 {
        (length * self.scale) as f32
    }
}

/// Where a ray starts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    position: Vec3,
    /// Towards the free side of the surface; zero in free space.
    normal: Vec3,
    /// How far along each axis the position may be off the surface.
    rounding: Vec3,
}

impl Start {
    /// In free space: whatever lies ahead is met.
    pub(crate) fn free(position: Vec3) -> Self {
        Self { position, normal: Vec3::ZERO, rounding: Vec3::ZERO }
    }

    /// On a surface, `position` being rounded to single precision.
    pub(crate) fn on_surface(position: Vec3, normal: Vec3) -> Self {
        Self { position, normal, rounding: ROUNDING * position.abs() }
    }

    /// The same with a position that may be off by `rounding` more.
    pub(crate) fn rougher(self, rounding: f32) -> Self {
        Self { rounding: self.rounding + Vec3::splat(rounding), ..self }
    }
}

struct Triangle([Vec3A; 3]);

/// The box around a triangle, as much larger as starts may lie beside it.
struct PaddedBox(Aabb);

impl Boundable for PaddedBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Triangle {
    /// Whether the line of a ray passes through the triangle: the volumes that it spans with the edges have one sign. Signs
    /// that single precision leaves in doubt, as near the corners of a large ground, are found in double precision.
    #[inline(always)]
    fn is_crossed(&self, origin: Vec3A, direction: Vec3A) -> bool {
        let [a, b, c] = self.0.map(|corner| corner - origin);
        let (ab, ac, across) = (b - a, c - a, direction.cross(a));
        let whole = ab.cross(ac).dot(direction);
        let (v, w) = (-across.dot(ac), across.dot(ab));
        let least = v.min(w).min(whole - v - w);
        let greatest = v.max(w).max(whole - v - w);
        let reach = a.abs().max(b.abs()).max(c.abs()).max_element();
        let doubt = VOLUME_ROUNDING * reach * ab.abs().max(ac.abs()).max_element();
        if least < -doubt && greatest > doubt {
            return false;
        }
        least > doubt || greatest < -doubt || self.is_crossed_exactly(origin, direction)
    }

    /// [`Self::is_crossed`] in double precision.
    #[cold]
    fn is_crossed_exactly(&self, origin: Vec3A, direction: Vec3A) -> bool {
        let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
        let [a, b, c] = self.0.map(|corner| corner.as_dvec3() - origin);
        let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| normal.dot(direction));
        volumes.iter().all(|volume| *volume >= 0.0) || volumes.iter().all(|volume| *volume <= 0.0)
    }

    /// The distance to where a ray from `origin` along `direction` crosses the triangle; infinite if it doesn't. Starting
    /// within `slack` along each axis of the triangle it meets what faces it though that be behind its origin, by at most
    /// `reach`, and doesn't meet what faces away.
    #[inline(always)]
    fn distance(&self, origin: Vec3A, direction: Vec3A, slack: Vec3A, reach: f32) -> f32 {
        if !self.is_crossed(origin, direction) {
            return f32::INFINITY;
        }
        // The distance to a large plane close by is the difference of large numbers.
        let [a, b, c] = self.0.map(|corner| corner.as_dvec3());
        let normal = (b - a).cross(c - a);
        let (ahead, facing) = (normal.dot(a - origin.as_dvec3()), normal.dot(direction.as_dvec3()));
        let off = normal.abs().dot(slack.as_dvec3());
        let is_met =
            if facing > 0.0 { ahead > off } else { facing < 0.0 && ahead < off && ahead < -facing * f64::from(reach) };
        if is_met { (ahead / facing) as f32 } else { f32::INFINITY }
    }

    /// Weights of the corners where the line of a ray crosses the plane.
    fn weights(&self, origin: DVec3, direction: DVec3) -> DVec3 {
        let [a, b, c] = self.0.map(|corner| corner.as_dvec3() - origin);
        let (ab, ac, across) = (b - a, c - a, direction.cross(a));
        let whole = ab.cross(ac).dot(direction);
        let (v, w) = (-across.dot(ac) / whole, across.dot(ab) / whole);
        DVec3::new(1.0 - v - w, v, w)
    }
}

/// Triangles, centred and scaled.
///
/// Not watertight: a ray aimed exactly at an edge may pass. Both faces of a triangle block.
pub(crate) struct TriangleRays {
    hierarchy: CwBvh,
    /// In the order of the hierarchy's leaves.
    triangles: Vec<Triangle>,
    /// In the same order; empty where all triangles are whole.
    holes: Vec<Holes>,
    space: RaySpace,
}

impl TriangleRays {
    /// Triangles with these corners; those that aren't finite are left out. `holes` has an entry for each, or none at all
    /// where all are whole.
    pub(crate) fn new(mut corners: Vec<[Vec3; 3]>, mut holes: Vec<Holes>) -> Self {
        let is_finite = |points: &[Vec3; 3]| points.iter().all(|point| point.is_finite());
        let mut is_kept = corners.iter().map(is_finite).collect::<Vec<_>>().into_iter();
        holes.retain(|_| is_kept.next().unwrap_or(false));
        corners.retain(is_finite);
        let low = corners.iter().flatten().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = corners.iter().flatten().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let space = RaySpace::around(low, high);
        let placed = |corners: &[Vec3; 3]| Triangle(corners.map(|point| space.place(point.as_dvec3())));
        let padded = |corners: &[Vec3; 3]| {
            let farthest = corners.iter().fold(Vec3::ZERO, |farthest, corner| farthest.max(corner.abs()));
            let padding = Vec3A::from(2.0 * (ROUNDING * space.length(1.0) * farthest + LEAST_ROUNDING + NEAREST));
            let tight = Aabb::from_points(&placed(corners).0);
            PaddedBox(Aabb::new(tight.min - padding, tight.max + padding))
        };
        let hierarchy = hierarchy(&corners.iter().map(padded).collect::<Vec<_>>());
        let triangles = hierarchy.primitive_indices.iter().map(|&slot| placed(&corners[slot as usize])).collect();
        let holes = match holes.as_slice() {
            [] => Vec::new(),
            list => hierarchy.primitive_indices.iter().map(|&slot| list[slot as usize].clone()).collect(),
        };
        Self { hierarchy, triangles, holes, space }
    }

    /// Whether a triangle lies on the ray within `distance`, which may be infinite. `direction` has unit length.
    ///
    /// The ray starts above its surface by twice what its start may be off it, and at least by 2^-45 of half the extent.
    pub(crate) fn blocked(&self, start: &Start, direction: Vec3, distance: f32) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let mut slack = start.rounding * self.space.length(1.0);
        let mut origin = self.space.place(start.position.as_dvec3());
        // A surface that a ray along it met farther behind may have been left again.
        let mut reach = REACH_BEHIND * slack.max_element();
        if start.normal != Vec3::ZERO {
            slack += LEAST_ROUNDING;
            let off = start.normal.abs().dot(slack);
            origin += Vec3A::from(2.0 * off * start.normal);
            // Farther behind, the ray may lie below the surface that it starts on.
            reach = (REACH_BEHIND * slack.max_element()).min(off / direction.dot(start.normal).max(f32::MIN_POSITIVE));
        }
        let limit = self.space.length(f64::from(distance));
        if !origin.is_finite() || !direction.is_finite() || limit.is_nan() {
            return false;
        }
        // -0.0 would make the hierarchy miss everything.
        let (direction, slack) = (Vec3A::from(direction) + 0.0, Vec3A::from(slack));
        let ray = Ray::new(origin, direction, 0.0, limit);
        let met = |slot: usize| self.triangles[slot].distance(origin, direction, slack, reach);
        if self.holes.is_empty() {
            return !self.hierarchy.ray_traverse_miss(ray, |_, slot| met(slot));
        }
        !self.hierarchy.ray_traverse_miss(ray, |_, slot| {
            let distance = met(slot);
            if distance.is_finite() && self.passes(origin, direction, slot) { f32::INFINITY } else { distance }
        })
    }

    /// Whether a ray that meets a triangle passes through a hole of it.
    fn passes(&self, origin: Vec3A, direction: Vec3A, slot: usize) -> bool {
        let Some((mesh, triangle)) = &self.holes[slot] else { return false };
        mesh.is_cut_out(*triangle as usize, self.triangles[slot].weights(origin.as_dvec3(), direction.as_dvec3()))
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.holes.as_slice())
            + size_of_val(self.hierarchy.nodes.as_slice())
            + size_of_val(self.hierarchy.primitive_indices.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hierarchies are built by areas, which must not overflow.
    #[test]
    fn hierarchies_are_built_of_what_is_tiny_or_far_out() {
        for far in [0.0, 1.0, 1e12, 1e28, 1e37] {
            for size in [1e-36, 1e-30, 1.0, 1e12] {
                // Triangles in a row, in the plane x = far.
                let corners = |i: u16| {
                    [[0.0, -1.0], [1.0, 2.0], [-1.0, 2.0]]
                        .map(|[y, z]| Vec3::new(far, size * (y + 3.0 * f32::from(i)), size * z))
                };
                let rays = TriangleRays::new((0..40).map(corners).collect(), Vec::new());
                let start = Start::free(Vec3::new(2.0 * far + size, size * 60.0, size));
                let is_met = |direction| rays.blocked(&start, direction, f32::INFINITY);
                assert!(!is_met(Vec3::X) && (is_met(Vec3::NEG_X) || size < far), "{far} {size}");
            }
        }
    }
}
