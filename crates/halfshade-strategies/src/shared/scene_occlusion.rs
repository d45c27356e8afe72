//! Rays against the meshes of one frame.

use super::triangle_rays::{Start, is_whole};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use halfshade_rays::{Crossing, Instance, MeshRays, SceneRays};
use halfshade_scene::{Frame, Mesh, Pose, Scene};
use std::sync::Arc;

/// The meshes of a scene, one by one, for the hierarchies of frames.
pub(crate) struct Meshes {
    /// By object; objects of one mesh share one.
    rays: Vec<Arc<MeshRays>>,
    /// Those with holes.
    cut_out: Vec<Option<Arc<Mesh>>>,
}

/// All triangles of a frame.
pub(crate) struct Occlusion<'a> {
    meshes: &'a Meshes,
    rays: &'a SceneRays,
}

impl Meshes {
    /// Those of a scene at rest.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut known: Vec<(&Arc<Mesh>, Arc<MeshRays>)> = Vec::new();
        for object in &scene.objects {
            let shared = known.iter().find(|(mesh, _)| object.skin.is_none() && Arc::ptr_eq(mesh, &object.mesh));
            let rays = match shared {
                Some((_, rays)) => rays.clone(),
                None => Arc::new(MeshRays::new(&object.mesh.positions, &object.mesh.triangles)),
            };
            known.push((&object.mesh, rays));
        }
        let rays = known.into_iter().map(|(_, rays)| rays).collect();
        let cut_out = |mesh: &Arc<Mesh>| mesh.has_cutouts().then(|| mesh.clone());
        Self { rays, cut_out: scene.objects.iter().map(|object| cut_out(&object.mesh)).collect() }
    }

    /// The hierarchy over all as they stand, those that deform being refitted.
    pub(crate) fn placed(&mut self, frame: &Frame<'_>) -> SceneRays {
        for (number, object) in frame.scene.objects.iter().enumerate().filter(|(_, object)| object.skin.is_some()) {
            Arc::make_mut(&mut self.rays[number]).refit(frame.positions(number), &object.mesh.triangles);
        }
        let instances = self.rays.iter().zip(&frame.world_from_object);
        let instances: Vec<Instance> =
            instances.map(|(mesh, pose)| Instance { mesh: mesh.clone(), world_from_mesh: affine(pose) }).collect();
        SceneRays::new(&instances)
    }

    pub(crate) fn bytes(&self) -> usize {
        let is_first = |number: usize| !self.rays[..number].iter().any(|other| Arc::ptr_eq(other, &self.rays[number]));
        (0..self.rays.len()).filter(|&number| is_first(number)).map(|number| self.rays[number].bytes()).sum()
    }
}

fn affine(pose: &Pose) -> DAffine3 {
    let (scale, rotation) = (DVec3::splat(f64::from(pose.scale)), DQuat::normalize(pose.rotation.as_dquat()));
    DAffine3::from_scale_rotation_translation(scale, rotation, pose.translation.as_dvec3())
}

impl<'a> Occlusion<'a> {
    /// The meshes as a frame has them.
    pub(crate) fn new(meshes: &'a Meshes, rays: &'a SceneRays) -> Self {
        Self { meshes, rays }
    }

    /// Whether a triangle lies on the ray from a point of a surface with unit `normal` within `distance` (world units, may be
    /// infinite). `direction` has unit length.
    pub(crate) fn blocked(&self, position: Vec3, normal: Vec3, direction: Vec3, distance: f32) -> bool {
        let ray = Start::on_surface(position, normal).ray(direction, distance, self.rays.half_extent());
        self.rays.any(&ray, |object, crossing| self.is_there(object, crossing))
    }

    /// The first crossing of such a ray, however far, and the number of the object.
    pub(crate) fn first_hit(&self, position: Vec3, normal: Vec3, direction: Vec3) -> Option<(u32, Crossing)> {
        let ray = Start::on_surface(position, normal).ray(direction, f32::INFINITY, self.rays.half_extent());
        self.rays.closest(&ray, |object, crossing| self.is_there(object, crossing))
    }

    /// Whether there is no hole where a ray crosses a triangle.
    fn is_there(&self, object: u32, crossing: &Crossing) -> bool {
        self.meshes.cut_out[object as usize].as_ref().is_none_or(|mesh| is_whole(mesh, crossing))
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
                let mut meshes = Meshes::new(&scene);
                let rays = meshes.placed(&scene.frame(0));
                let occlusion = Occlusion::new(&meshes, &rays);
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
