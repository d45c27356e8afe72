//! The lobes that receivers show to the eye.

use crate::reflectance::tangent;
use crate::{Frame, Gloss, Receivers, Reflectance, lobe::Lobes};
use glam::{Quat, Vec3};

/// The lobes of receivers of one frame, for radiance towards the eye of the scene's camera.
///
/// A receiver shows the eye the lobes of its object's [`Reflectance`], with the receiver's own [`Gloss`]. Anisotropic
/// lobes are about a tangent that turns with the object.
#[derive(Debug, Clone)]
pub struct EyeLobes {
    eye: Vec3,
    objects: Vec<(Reflectance, Quat)>,
}

impl EyeLobes {
    /// `None` where nothing is glossy: then there is nothing to pay for.
    pub fn new(frame: &Frame<'_>) -> Option<Self> {
        let objects = frame.scene.objects.iter().zip(&frame.world_from_object);
        frame.scene.is_glossy().then(|| Self {
            eye: frame.scene.camera.eye,
            objects: objects.map(|(object, pose)| (object.material.reflectance.clone(), pose.rotation)).collect(),
        })
    }

    /// The lobes of receiver `i`, which is seen from the eye. Their axes are in world space.
    pub fn at(&self, receivers: &Receivers<'_>, i: usize) -> Lobes {
        let offset = self.eye.as_dvec3() - receivers.position_at(i).as_dvec3();
        self.toward(
            receivers.object[i],
            receivers.gloss_at(i),
            receivers.normal_at(i),
            offset.normalize_or_zero().as_vec3(),
        )
    }

    /// The lobes of a point of an object as seen along unit `to_eye`. No object of that number has none.
    pub fn toward(&self, object: u32, gloss: Gloss, normal: Vec3, to_eye: Vec3) -> Lobes {
        match self.objects.get(object as usize) {
            None | Some((Reflectance::Lambert, _)) => Lobes::NONE,
            Some((reflectance, rotation)) => {
                let tangent = *rotation * tangent(rotation.conjugate() * normal);
                reflectance.lobes(gloss, normal, tangent, to_eye)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Environment, GlossVariation, Material, Object, Pose, ReceiverBuffer, Scene, builtin::shapes,
        reflectance::LafortuneLobe,
    };
    use std::sync::Arc;

    fn object(material: Material, pose: Pose) -> Object {
        Object::new("ball", shapes::sphere(4)).material(material).pose(pose)
    }

    fn scene(objects: Vec<Object>) -> Scene {
        Scene::at_rest("gloss", objects, Environment::constant(Vec3::ONE))
    }

    fn brushed() -> Material {
        let lobe = LafortuneLobe { scale: Vec3::ONE, axis: Vec3::new(-1.0, -0.5, 0.9), exponent: 5.0 };
        Material { reflectance: Reflectance::Lafortune { lobes: vec![lobe] }, ..Material::default() }
    }

    #[test]
    fn where_nothing_is_glossy_there_is_nothing() {
        let black = Reflectance::Phong { specular: Vec3::ZERO, exponent: 3.0 };
        let dull = scene(vec![object(Material { reflectance: black, ..Material::default() }, Pose::IDENTITY)]);
        assert!(EyeLobes::new(&dull.frame(0)).is_none());
        let receivers = ReceiverBuffer::vertices(&dull.frame(0));
        assert!(receivers.exponent_factor.is_empty() && receivers.view().gloss_at(3) == Gloss::NEUTRAL);
    }

    #[test]
    fn lobes_turn_with_the_object() {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), 1.3);
        let pose = Pose { rotation: turn, ..Pose::IDENTITY };
        let (still, turned) = (scene(vec![object(brushed(), Pose::IDENTITY)]), scene(vec![object(brushed(), pose)]));
        let lobes = |scene: &Scene, normal, to_eye| {
            EyeLobes::new(&scene.frame(0)).unwrap().toward(0, Gloss::NEUTRAL, normal, to_eye)
        };
        let (normal, to_eye) = (Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.48, 0.6, 0.64));
        let (before, after) = (lobes(&still, normal, to_eye), lobes(&turned, turn * normal, turn * to_eye));
        assert!(after[0].axis.distance(turn * before[0].axis) < 1e-6);
        assert!((after[0].scale - before[0].scale).abs().max_element() < 1e-5);
    }

    #[test]
    fn vertices_and_textures_vary_gloss_and_receivers_carry_it() {
        let count = shapes::sphere(4).positions.len();
        let vertices: Vec<Gloss> =
            (0..count).map(|i| Gloss { specular: Vec3::splat(i as f32 / count as f32), exponent: 0.5 }).collect();
        let variation = GlossVariation { vertices: vertices.clone(), ..GlossVariation::default() };
        let material = Material { gloss_variation: Some(Arc::new(variation)), ..brushed() };
        // The first object varies, the second doesn't.
        let scene = scene(vec![object(material, Pose::IDENTITY), object(brushed(), Pose::IDENTITY)]);
        let buffer = ReceiverBuffer::vertices(&scene.frame(0));
        let view = buffer.view();
        assert_eq!((view.gloss_at(3), view.gloss_at(count + 3)), (vertices[3], Gloss::NEUTRAL));
        let part = view.slice(2..count);
        assert_eq!(part.gloss_at(1), vertices[3]);
        assert_eq!(ReceiverBuffer::gathered(view, &[5, 3]).view().gloss_at(1), vertices[3]);
        let triangle = scene.objects[0].mesh.triangles[0];
        let middle = scene.objects[0].gloss_at(0, glam::DVec3::new(0.5, 0.5, 0.0));
        let expected = 0.5 * (vertices[triangle[0] as usize].specular + vertices[triangle[1] as usize].specular);
        assert!(middle.specular.distance(expected) < 1e-6 && middle.exponent == 0.5);
    }
}
