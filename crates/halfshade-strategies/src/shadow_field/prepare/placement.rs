//! Poses and lights of a frame as [`FrameData`].

use super::frame::{FrameData, LocalLight, ObjectPlacement};
use crate::{
    shadow_field::{
        bake::{bounds::BoundingSphere, meshes::BakedObject},
        kernel::light_order::Containment,
    },
    shared::origin::origin_of,
};
use glam::{DMat3, DQuat, DVec3, Vec3};
use halfshade_scene::{EyeLobes, Frame, Pose, SphereLight};
use halfshade_strategy::StrategyError;

impl FrameData {
    /// A frame of the scene of these objects.
    pub(crate) fn new<S, O>(frame: &Frame<'_>, objects: &[BakedObject<S, O>]) -> Result<Self, StrategyError> {
        if frame.scene.objects.len() != objects.len() {
            return Err(StrategyError::Failed("the frame is of another scene than fields were baked for".into()));
        }
        let light_from_world = frame.world_from_environment.as_dquat().normalize().conjugate();
        let centers: Vec<DVec3> = (frame.world_from_object.iter().zip(objects))
            .map(|(pose, object)| {
                pose.rotation.as_dquat().normalize() * (f64::from(pose.scale) * object.bounds.center.as_dvec3())
                    + pose.translation.as_dvec3()
            })
            .collect();
        let mut data = Self {
            objects: Vec::new(),
            lights: Vec::new(),
            nearest_first: Vec::new(),
            eye_lobes: EyeLobes::new(frame),
            light_from_world,
            origin: origin_of(centers.iter().copied()),
        };
        data.objects = (frame.world_from_object.iter().zip(&centers).zip(objects))
            .map(|((pose, &center), object)| placement(pose, data.point(center), object.bounds, light_from_world))
            .collect();
        data.lights = frame.lights.iter().map(|light| data.local_light(light)).collect();
        data.nearest_first = (0..objects.len()).map(|object| data.nearest_first_from(object)).collect();
        Ok(data)
    }

    fn local_light(&self, light: &SphereLight) -> LocalLight {
        let center = self.point(light.center.as_dvec3());
        let containment = |object: &ObjectPlacement| {
            let distance = Vec3::from(object.center).distance(center.into());
            match object.radius {
                radius if distance + radius <= light.radius => Containment::Whole,
                _ if distance <= light.radius => Containment::Center,
                _ => Containment::Outside,
            }
        };
        let holds = self.objects.iter().map(containment).collect();
        LocalLight { center, radius: light.radius, radiance: light.radiance.to_array(), holds }
    }

    /// All others, by the distance of their centres: the same for all of an object, so that shading has no steps on it.
    fn nearest_first_from(&self, object: usize) -> Vec<usize> {
        let center = Vec3::from(self.objects[object].center);
        let distance = |other: usize| center.distance_squared(self.objects[other].center.into());
        let mut order: Vec<usize> = (0..self.objects.len()).filter(|&other| other != object).collect();
        order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        order
    }
}

fn placement(pose: &Pose, center: [f32; 3], bounds: BoundingSphere, light_from_world: DQuat) -> ObjectPlacement {
    let light_from_object = light_from_world * pose.rotation.as_dquat().normalize();
    let columns = DMat3::from_quat(light_from_object).to_cols_array_2d();
    let radius = bounds.radius * pose.scale;
    ObjectPlacement {
        center,
        // The columns of a rotation are the rows of its inverse.
        object_from_light: columns.map(|column| column.map(|value| value as f32)),
        inverse_scale: pose.scale.recip(),
        radius,
        inverse_radius: radius.max(f32::MIN_POSITIVE).recip(),
    }
}
