//! Objects that block, and how their spheres follow them.

use crate::shared::{
    light_space::LightSpace,
    placed_spheres::{followed, placed},
};
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

    /// Centres and radii in world space of all spheres of a frame, object by object.
    pub(crate) fn placed_by_object(&self, frame: &Frame<'_>) -> impl Iterator<Item = Vec<(DVec3, f32)>> {
        let of_object = move |(number, (blocker, pose)): (usize, (&Option<Blocker>, &Pose))| -> Vec<(DVec3, f32)> {
            let Some(Blocker { set, binding }) = blocker else { return Vec::new() };
            let (mesh, deformed) = (&frame.scene.objects[number].mesh, frame.deformed(number));
            let rotation = pose.rotation.as_dquat().normalize();
            let placed = |followed: Followed| placed(&followed.sphere, pose, rotation);
            followed(&set.spheres, binding.as_ref(), mesh, deformed).into_iter().map(placed).collect()
        };
        self.0.iter().zip(&frame.world_from_object).enumerate().map(of_object)
    }

    /// All of them, one object's after another's.
    pub(crate) fn placed(&self, frame: &Frame<'_>) -> Vec<(DVec3, f32)> {
        self.placed_by_object(frame).flatten().collect()
    }
}

/// One sphere in light space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockingSphere {
    /// Centre.
    pub center: [f32; 3],
    /// Radius.
    pub radius: f32,
    /// The object that it stands for.
    pub object: u32,
}

/// Spheres of the world, object by object, in light space.
pub(crate) fn blocking_spheres(by_object: &[Vec<(DVec3, f32)>], space: &LightSpace) -> Vec<BlockingSphere> {
    let of_object = |(object, spheres): (usize, &Vec<(DVec3, f32)>)| -> Vec<BlockingSphere> {
        let sphere = |&(center, radius): &(DVec3, f32)| BlockingSphere {
            center: space.point(center).to_array(),
            radius,
            object: object as u32,
        };
        spheres.iter().map(sphere).collect()
    };
    by_object.iter().enumerate().flat_map(of_object).collect()
}
