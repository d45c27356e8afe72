//! Rays that ask whether anything of a mesh is in the way.

use glam::{DVec3, Vec3};
use halfshade_rays::{Crossing, MeshRays, Ray};
use halfshade_scene::Mesh;

/// How far a coordinate may be off the surface that it stands for, as a part of itself: rounding of the point, and of what
/// it was made of, with room.
pub(crate) const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Added to that, as a part of half the extent of what is traced: 2^-46. Points at coordinate 0 are exact, but the distance to a
/// plane is found in double precision only.
const LEAST_ROUNDING: f64 = 1.0 / (1_u64 << 46) as f64;

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

    /// A ray along unit `direction`, shorter than `limit`, among triangles of half the extent `half_extent`. It starts above its
    /// surface by twice what its start may be off it.
    pub(crate) fn ray(&self, direction: Vec3, limit: f32, half_extent: f64) -> Ray {
        let (position, direction) = (self.position.as_dvec3(), direction.as_dvec3());
        if self.normal == Vec3::ZERO {
            return Ray::new(position, direction).until(f64::from(limit));
        }
        let normal = self.normal.as_dvec3();
        let slack = self.rounding.as_dvec3() + DVec3::splat(LEAST_ROUNDING * half_extent);
        let lift = 2.0 * normal.abs().dot(slack) * normal;
        Ray::new(position + lift, direction).until(f64::from(limit)).leaving(normal, slack)
    }
}

/// A mesh with the holes that masks cut in it. Both faces of a triangle block.
pub(crate) struct TriangleRays {
    rays: MeshRays,
    /// If it has holes.
    cut_out: Option<Mesh>,
}

impl TriangleRays {
    /// In the mesh's own space.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self {
            rays: MeshRays::new(&mesh.positions, &mesh.triangles),
            cut_out: mesh.has_cutouts().then(|| mesh.clone()),
        }
    }

    /// Whether a triangle lies on the ray within `limit`, which may be infinite. `direction` has unit length.
    pub(crate) fn blocked(&self, start: &Start, direction: Vec3, limit: f32) -> bool {
        let ray = start.ray(direction, limit, self.rays.half_extent());
        match &self.cut_out {
            None => self.rays.any(&ray, |_| true),
            Some(mesh) => self.rays.any(&ray, |crossing| is_whole(mesh, crossing)),
        }
    }
}

/// Whether a mesh is there where a ray crosses it.
pub(crate) fn is_whole(mesh: &Mesh, crossing: &Crossing) -> bool {
    let triangle = crossing.triangle as usize;
    mesh.mask_of(triangle).is_none() || !mesh.is_cut_out(triangle, crossing.weights())
}
