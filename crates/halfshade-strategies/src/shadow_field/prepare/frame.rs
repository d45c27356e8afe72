//! Objects and local lights of a frame in the space of the distant light, whatever the basis.

use crate::shadow_field::kernel::{
    light_order::{Containment, LightSeen, is_before},
    shell_coordinates::{object_axes, shell_coordinates},
};
use glam::{DQuat, DVec3, Mat3, Vec3};
use halfshade_scene::EyeLobes;
use wide::f32x8;

/// A frame. Lengths are about its origin, so that a scene may lie anywhere.
#[derive(Debug)]
pub(crate) struct FrameData {
    pub(crate) objects: Vec<ObjectPlacement>,
    pub(crate) lights: Vec<LocalLight>,
    /// Per object the others, from near to far.
    pub(crate) nearest_first: Vec<Vec<usize>>,
    /// Glossy reflectance towards the eye, if anything has it.
    pub(crate) eye_lobes: Option<EyeLobes>,
    pub(crate) light_from_world: DQuat,
    pub(crate) origin: DVec3,
}

/// Where an object is in this frame.
#[derive(Debug, Clone)]
pub struct ObjectPlacement {
    /// Centre of its bounding sphere in light space.
    pub center: [f32; 3],
    /// Object space from light space, row by row, without the scale.
    pub object_from_light: [[f32; 3]; 3],
    /// 1 over the object's scale.
    pub inverse_scale: f32,
    /// Radius of its bounding sphere in the world.
    pub radius: f32,
    /// 1 over that radius.
    pub inverse_radius: f32,
}

/// A local light in light space.
#[derive(Debug, Clone)]
pub struct LocalLight {
    /// Centre.
    pub center: [f32; 3],
    /// Radius, in world units.
    pub radius: f32,
    /// Radiance of its surface, by channel.
    pub radiance: [f32; 3],
    /// Per object how much of it lies within the light.
    pub holds: Vec<Containment>,
}

impl FrameData {
    /// A point of the world in light space.
    pub(crate) fn point(&self, point: DVec3) -> [f32; 3] {
        (self.light_from_world * (point - self.origin)).as_vec3().to_array()
    }

    /// A direction of the world in light space.
    pub(crate) fn direction(&self, direction: Vec3) -> Vec3 {
        (self.light_from_world * direction.as_dvec3()).as_vec3()
    }

    /// Where eight receivers see a light.
    #[inline(always)]
    pub(crate) fn see(&self, light: usize, position: &[f32x8; 3]) -> LightSeen {
        let light = &self.lights[light];
        LightSeen::new(&light.center, light.radius, position)
    }

    /// Whether an object is before a light for each of eight receivers, as a mask.
    #[inline(always)]
    pub(crate) fn is_before(&self, object: usize, light: usize, seen: &LightSeen, position: &[f32x8; 3]) -> f32x8 {
        is_before(self.lights[light].holds[object], &self.objects[object].center, seen, position)
    }
}

impl ObjectPlacement {
    /// The rotation from light space to object space.
    pub(crate) fn rotation(&self) -> Mat3 {
        Mat3::from_cols_array_2d(&self.object_from_light).transpose()
    }

    /// Eight points of light space relative to the centre of the object's bounding sphere, in the object's space.
    #[inline(always)]
    pub(crate) fn in_object(&self, position: &[f32x8; 3]) -> [f32x8; 3] {
        object_axes(position, &self.center, &self.object_from_light).map(|axis| axis * f32x8::splat(self.inverse_scale))
    }

    /// The same of one point.
    pub(crate) fn point_in_object(&self, position: [f32; 3]) -> Vec3 {
        self.in_object(&position.map(f32x8::splat)).map(|axis| axis.as_array()[0]).into()
    }

    /// The largest of the numbers that [`Self::point_in_object`] subtracts, in the object's space: its result is rounded as
    /// these are.
    pub(crate) fn largest_term(&self, position: [f32; 3]) -> f32 {
        position.iter().chain(&self.center).fold(0.0, |largest: f32, x| largest.max(x.abs())) * self.inverse_scale
    }

    /// Eight points of light space in the coordinates of the object's shells.
    #[inline(always)]
    pub(crate) fn on_shells(&self, position: &[f32x8; 3]) -> [f32x8; 3] {
        shell_coordinates(object_axes(position, &self.center, &self.object_from_light), self.inverse_radius)
    }
}
