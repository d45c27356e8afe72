//! Objects that block, and how their spheres follow them.

use crate::shared::placed_spheres::{followed, placed};
use glam::DVec3;
use halfshade_scene::{
    Frame, Object, Pose, Scene, SphereSet,
    spheres::{Followed, SphereBinding},
};
use std::sync::Arc;

/// The sphere set of an object, and how it follows the object's mesh if that deforms.
#[derive(Debug)]
pub(crate) struct Blocker {
    set: Arc<SphereSet>,
    binding: Option<SphereBinding>,
}

/// The objects of a scene that block, in its order.
#[derive(Debug)]
pub(crate) struct Blockers(Vec<Option<Blocker>>);

impl Blockers {
    pub(crate) fn new(scene: &Scene) -> Self {
        let blocker = |object: &Object| {
            let set = object.spheres.as_ref().filter(|_| object.sphere_count > 0)?;
            let binding = object.skin.as_ref().map(|_| SphereBinding::new(&object.mesh, &set.spheres, set.fit));
            Some(Blocker { set: set.clone(), binding })
        };
        Self(scene.objects.iter().map(blocker).collect())
    }

    /// Number of objects of the scene.
    pub(crate) fn object_count(&self) -> usize {
        self.0.len()
    }

    /// Bytes of the bindings.
    pub(crate) fn bytes(&self) -> usize {
        self.0.iter().flatten().filter_map(|blocker| blocker.binding.as_ref()).map(SphereBinding::bytes).sum()
    }

    /// Centres and radii in world space of all spheres of a frame.
    pub(crate) fn placed(&self, frame: &Frame<'_>) -> Vec<(DVec3, f32)> {
        let of_object = |(number, (blocker, pose)): (usize, (&Option<Blocker>, &Pose))| -> Vec<(DVec3, f32)> {
            let Some(Blocker { set, binding }) = blocker else { return Vec::new() };
            let (mesh, deformed) = (&frame.scene.objects[number].mesh, frame.deformed(number));
            let rotation = pose.rotation.as_dquat().normalize();
            let placed = |followed: Followed| placed(&followed.sphere, pose, rotation);
            followed(&set.spheres, binding.as_ref(), mesh, deformed).into_iter().map(placed).collect()
        };
        self.0.iter().zip(&frame.world_from_object).enumerate().flat_map(of_object).collect()
    }
}
