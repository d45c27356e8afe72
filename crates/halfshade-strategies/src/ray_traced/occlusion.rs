//! Shadow rays against the meshes of one frame.

use glam::{Vec3, Vec3A};
use halfshade_scene::Frame;
use obvhs::{
    BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh},
    ray::Ray,
    rt_triangle::RtTriangle,
};
use std::time::Duration;

/// Half the scene's largest extent in the space that rays are traced in. obvhs ignores hits nearer than 1e-4, whatever
/// the scene's size: here that is two units in the last place.
const HALF_EXTENT: f32 = 512.0;

/// How far rays start above the surface, in units of the traced space: 2e-6 of half the extent.
const LIFT: f32 = 1e-3;

/// All triangles of a frame, centred and scaled, in a wide bounding-volume hierarchy.
///
/// Not watertight: a ray aimed exactly at an edge may pass. Both faces of a triangle block.
pub(super) struct Occlusion {
    hierarchy: CwBvh,
    /// In the order of the hierarchy's leaves.
    triangles: Vec<RtTriangle>,
    center: Vec3,
    scale: f32,
    lift: f32,
}

impl Occlusion {
    pub(super) fn new(frame: &Frame<'_>) -> Self {
        let mut corners: Vec<[Vec3; 3]> = Vec::new();
        for (number, (object, pose)) in frame.scene.objects.iter().zip(&frame.world_from_object).enumerate() {
            let placed: Vec<Vec3> = frame.positions(number).iter().map(|&point| pose.transform_point(point)).collect();
            corners.extend(object.mesh.triangles.iter().map(|triangle| triangle.map(|vertex| placed[vertex as usize])));
        }
        corners.retain(|points| points.iter().all(|point| point.is_finite()));
        let low = corners.iter().flatten().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = corners.iter().flatten().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let center = low + 0.5 * (high - low);
        let half = 0.5 * (high - low).max_element();
        let scale = if half > 0.0 { (HALF_EXTENT / half).min(f32::MAX.sqrt()) } else { 1.0 };
        let place = |point: Vec3| Vec3A::from((point - center) * scale);
        let triangles: Vec<RtTriangle> =
            corners.iter().map(|&[a, b, c]| RtTriangle::new(place(a), place(b), place(c))).collect();
        let hierarchy = if triangles.is_empty() {
            CwBvh::default()
        } else {
            build_cwbvh(&triangles, BvhBuildParams::medium_build(), &mut Duration::default())
        };
        let triangles = hierarchy.primitive_indices.iter().map(|&slot| triangles[slot as usize]).collect();
        // Far from the origin world coordinates are coarse: positions that were rounded apart must not hide the sky.
        let coarseness = low.abs().max(high.abs()).max_element() * f32::EPSILON * scale;
        Self { hierarchy, triangles, center, scale, lift: LIFT + 2.0 * coarseness }
    }

    /// Whether a triangle lies on the ray within `distance` (world units, may be infinite). `direction` has unit length.
    pub(super) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3, distance: f32) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let origin = Vec3A::from((position - self.center) * self.scale + self.lift * normal);
        let limit = distance * self.scale;
        if !origin.is_finite() || !direction.is_finite() || limit.is_nan() {
            return false;
        }
        // -0.0 would make the hierarchy miss everything.
        let ray = Ray::new(origin, Vec3A::from(direction) + 0.0, 0.0, limit);
        !self.hierarchy.ray_traverse_miss(ray, |ray, slot| self.triangles[slot].intersect(ray))
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.hierarchy.nodes.as_slice())
            + size_of_val(self.hierarchy.primitive_indices.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::with_spheres;
    use halfshade_scene::{Environment, Sphere};

    #[test]
    fn blocks_what_a_sphere_blocks_at_any_scale() {
        for scale in [1e-3f32, 1.0, 1e3] {
            for shift in [Vec3::ZERO, Vec3::new(50.0, -20.0, 8.0) * scale] {
                let sphere = Sphere { center: scale * Vec3::new(0.0, 2.0, 0.0) + shift, radius: scale };
                let scene = with_spheres(Environment::constant(Vec3::ONE), &[sphere]);
                let occlusion = Occlusion::new(&scene.frame(0));
                let up = |direction: Vec3, reach: f32| occlusion.blocked(shift, Vec3::Y, direction.normalize(), reach);
                assert!(up(Vec3::Y, f32::INFINITY) && up(Vec3::new(0.4, 1.0, 0.0), f32::INFINITY));
                assert!(up(Vec3::Y, 1.1 * scale) && !up(Vec3::Y, 0.9 * scale));
                assert!(!up(Vec3::new(0.7, 1.0, 0.0), f32::INFINITY) && !up(Vec3::X, f32::INFINITY));
                // From its own surface outwards: nothing.
                for &point in &scene.objects[0].mesh.positions {
                    let position = scale * point + sphere.center;
                    assert!(!occlusion.blocked(position, point, point, f32::INFINITY));
                }
            }
        }
    }
}
