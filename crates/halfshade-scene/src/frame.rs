//! One moment of a scene: the poses and the light that strategies see in `prepare`.

use crate::{Deformed, Object, Pose, Scene, SphereLight, spheres::SphereBinding};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// One moment of a scene. Fields are public so that tests can build moments no time line holds.
#[derive(Debug, Clone)]
pub struct Frame<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Frame number.
    pub index: usize,
    /// Pose of each object, in the order of `scene.objects`.
    pub world_from_object: Vec<Pose>,
    /// Vertices of each object that has left its rest, in the same order.
    pub deformed: Vec<Option<Arc<Deformed>>>,
    /// Rotation of the environment.
    pub world_from_environment: Quat,
    /// The local lights, moved.
    pub lights: Vec<SphereLight>,
}

/// Places of all objects of a frame: what is equal needs no new acceleration structure.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placement {
    world_from_object: Vec<Pose>,
    deformed: Vec<Option<Arc<Deformed>>>,
}

impl Scene {
    /// The scene at frame `index`. Frames past the end are valid: motions hold their last pose.
    pub fn frame(&self, index: usize) -> Frame<'_> {
        let time_secs = index as f64 / self.frames_per_sec;
        Frame {
            scene: self,
            index,
            world_from_object: self.objects.iter().map(|object| object.motion.at(time_secs)).collect(),
            deformed: self.objects.iter().map(|object| object.deformed(time_secs)).collect(),
            world_from_environment: Quat::from_axis_angle(Vec3::Y, self.environment_turn_at(time_secs)),
            lights: self.lights.iter().map(|(light, motion)| light.moved(&motion.at(time_secs))).collect(),
        }
    }
}

impl Frame<'_> {
    /// Radiance that arrives from infinitely far along unit `direction_in_world` (pointing away from the receiver).
    pub fn environment_radiance(&self, direction_in_world: Vec3) -> Vec3 {
        self.scene.environment.radiance(self.world_from_environment.conjugate() * direction_in_world)
    }

    /// Positions of an object's vertices, in its own space.
    pub fn positions(&self, object: usize) -> &[Vec3] {
        match self.deformed(object) {
            Some(deformed) => &deformed.positions,
            None => &self.scene.objects[object].mesh.positions,
        }
    }

    /// Unit normals of an object's vertices, in its own space.
    pub fn normals(&self, object: usize) -> &[Vec3] {
        match self.deformed(object) {
            Some(deformed) => &deformed.normals,
            None => &self.scene.objects[object].mesh.normals,
        }
    }

    /// An object's vertices, if it has left its rest.
    pub fn deformed(&self, object: usize) -> Option<&Deformed> {
        self.deformed.get(object).and_then(Option::as_deref)
    }

    /// An object as it is now: its own copy of mesh and spheres if it has left its rest.
    pub fn object(&self, object: usize) -> Object {
        let mut now = self.scene.objects[object].clone();
        if let Some(deformed) = self.deformed(object) {
            if let Some(set) = &mut now.spheres {
                let binding = SphereBinding::new(&now.mesh, &set.spheres, set.fit);
                let followed = binding.follow(&now.mesh.positions, &deformed.positions);
                Arc::make_mut(set).spheres = followed.into_iter().map(|followed| followed.sphere).collect();
            }
            let mesh = Arc::make_mut(&mut now.mesh);
            mesh.positions.clone_from(&deformed.positions);
            mesh.normals.clone_from(&deformed.normals);
            now.skin = None;
        }
        now
    }

    /// Places of all objects.
    pub fn placement(&self) -> Placement {
        Placement { world_from_object: self.world_from_object.clone(), deformed: self.deformed.clone() }
    }

    /// Whether all objects are where `placement` says.
    pub fn is_placed_as(&self, placement: &Placement) -> bool {
        self.world_from_object == placement.world_from_object && self.deformed == placement.deformed
    }
}
