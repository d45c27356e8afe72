//! Shadow rays against the meshes of one frame.

use crate::shared::triangle_rays::{Holes, Start, TriangleRays, holes_of};
use glam::Vec3;
use halfshade_scene::Frame;

/// All triangles of a frame.
pub(crate) struct Occlusion(TriangleRays);

impl Occlusion {
    pub(crate) fn new(frame: &Frame<'_>) -> Self {
        let (mut corners, mut holes): (Vec<[Vec3; 3]>, Vec<Holes>) = (Vec::new(), Vec::new());
        let has_holes = frame.scene.objects.iter().any(|object| object.mesh.has_cutouts());
        for (number, (object, pose)) in frame.scene.objects.iter().zip(&frame.world_from_object).enumerate() {
            let placed: Vec<Vec3> = frame.positions(number).iter().map(|&point| pose.transform_point(point)).collect();
            corners.extend(object.mesh.triangles.iter().map(|triangle| triangle.map(|vertex| placed[vertex as usize])));
            if has_holes {
                holes.extend(holes_of(&object.mesh));
            }
        }
        Self(TriangleRays::new(corners, holes))
    }

    /// Whether a triangle lies on the ray from a point of a surface with unit `normal` within `distance` (world units, may be
    /// infinite). `direction` has unit length.
    pub(crate) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3, distance: f32) -> bool {
        self.0.blocked(&Start::on_surface(position, normal), direction, distance)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::with_spheres;
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
