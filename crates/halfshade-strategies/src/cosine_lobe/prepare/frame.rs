//! Frame data: everything that shading reads of a frame.

use super::{light::Light, surroundings::Surroundings};
use crate::{
    cosine_lobe::{
        bake::environment::FittedEnvironment,
        kernel::spheres::{BoundingSphere, Spheres},
    },
    shared::{blockers::Blockers, origin::origin_of},
};
use glam::{DVec3, Vec3};
use halfshade_scene::{EyeLobes, Frame};

/// Spheres and light of a frame. Lengths are about its origin, so that a scene may lie anywhere.
#[derive(Debug)]
pub(crate) struct FrameData {
    pub(crate) origin: DVec3,
    pub(crate) spheres: Spheres,
    /// The bounding sphere of all of them.
    pub(crate) bounds: BoundingSphere,
    pub(crate) lights: Vec<Light>,
    pub(crate) surroundings: Option<Surroundings>,
    /// All directions alike, for receivers within a light.
    pub(crate) everywhere: Option<Surroundings>,
    pub(crate) eye_lobes: Option<EyeLobes>,
}

impl FrameData {
    /// A frame of a scene with these blockers and this environment.
    pub(crate) fn new(
        frame: &Frame<'_>,
        blockers: &Blockers,
        environment: &FittedEnvironment,
        everywhere: Option<&FittedEnvironment>,
    ) -> Self {
        let placed = blockers.placed(frame);
        let origin = origin_of(placed.iter().map(|(center, _)| *center));
        let spheres = Spheres::about(origin, &placed);
        let rotation = frame.world_from_environment;
        let near = frame.lights.iter().map(|light| Light::near(light, origin));
        let suns = frame.scene.environment.sun.iter().chain(environment.lamps());
        let far = suns.map(|sun| Light::far(sun, rotation));
        Self {
            origin,
            bounds: spheres.bounds(),
            spheres,
            lights: near.chain(far).collect(),
            surroundings: Surroundings::new(environment, rotation),
            everywhere: everywhere.and_then(|fitted| Surroundings::new(fitted, rotation)),
            eye_lobes: EyeLobes::new(frame),
        }
    }

    /// A point of the world, about the origin.
    pub(crate) fn local(&self, point: Vec3) -> [f32; 3] {
        (point.as_dvec3() - self.origin).as_vec3().to_array()
    }
}
