//! The state on which a frame's preparation depends, so that a frame in which nothing moved costs nothing.

use glam::Quat;
use halfshade_scene::{Environment, Frame, Placement, SphereLight, SphereSet};
use std::sync::Arc;

/// Objects, spheres and light of the frame that was prepared last.
#[derive(Debug, Clone)]
pub(crate) struct FrameState {
    placement: Placement,
    spheres: Vec<Option<Arc<SphereSet>>>,
    environment: Environment,
    world_from_environment: Quat,
    lights: Vec<SphereLight>,
}

impl FrameState {
    pub(crate) fn of(frame: &Frame<'_>) -> Self {
        Self {
            placement: frame.placement(),
            spheres: frame.scene.objects.iter().map(|object| object.spheres.clone()).collect(),
            environment: frame.scene.environment.clone(),
            world_from_environment: frame.world_from_environment,
            lights: frame.lights.clone(),
        }
    }

    /// Whether `frame` is in the same state. Sphere sets are compared by their place in memory.
    pub(crate) fn is(&self, frame: &Frame<'_>) -> bool {
        let (environment, objects) = (&frame.scene.environment, &frame.scene.objects);
        let same_spheres = |(known, object): (&Option<Arc<SphereSet>>, &halfshade_scene::Object)| {
            known.as_ref().map(Arc::as_ptr) == object.spheres.as_ref().map(Arc::as_ptr)
        };
        frame.is_placed_as(&self.placement)
            && self.spheres.len() == objects.len()
            && self.spheres.iter().zip(objects).all(same_spheres)
            && self.world_from_environment == frame.world_from_environment
            && self.lights == frame.lights
            && self.environment.is_same_as(environment)
    }
}
