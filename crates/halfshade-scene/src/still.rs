//! A moving scene held still, for methods that need one that doesn't move.

use crate::{Motion, Pose, Scene};

impl Scene {
    /// The scene held still as it is at frame `index`: one frame, in which nothing moves. Objects keep the poses of that frame and
    /// meshes their shape; spheres that are built follow them, others are built of the mesh as it is. What the truth finds is
    /// the same, to the last bit.
    pub fn still_at(&self, index: usize) -> Self {
        let frame = self.frame(index);
        let objects = frame.world_from_object.iter().enumerate().map(|(number, pose)| {
            let mut object = frame.object(number).pose(*pose);
            object.skin = None;
            object
        });
        let lights = frame.lights.iter().map(|light| (*light, Motion::Still(Pose::IDENTITY))).collect();
        Self {
            name: format!("{}, still at frame {index}", self.name),
            objects: objects.collect(),
            environment_turn: self.environment_turn_at(index as f64 / self.frames_per_sec),
            environment_turn_per_sec: 0.0,
            lights,
            frame_count: 1,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SphereLight, builtin};
    use glam::Vec3;

    #[test]
    fn nothing_moves_and_everything_is_where_it_was() {
        for (name, _) in builtin::SCENES {
            let mut scene = builtin::scene(name).unwrap();
            scene.environment_turn_per_sec = 0.7;
            let index = scene.frame_count / 3;
            let still = scene.still_at(index);
            let (then, now) = (scene.frame(index), still.frame(0));
            assert_eq!(still.frame_count, 1);
            assert!(still.objects.iter().all(|object| !object.motion.moves() && object.skin.is_none()), "{name}");
            assert!(still.lights.iter().all(|(_, motion)| !motion.moves()), "{name}");
            assert_eq!(now.world_from_object, then.world_from_object, "{name}");
            assert_eq!(
                (now.world_from_environment, &now.lights),
                (then.world_from_environment, &then.lights),
                "{name}"
            );
            for object in 0..scene.objects.len() {
                assert_eq!(now.positions(object), then.positions(object), "{name}");
                assert_eq!(now.normals(object), then.normals(object), "{name}");
            }
            // Whatever frame of it is asked for.
            assert_eq!(still.frame(index).world_from_object, then.world_from_object);
            assert_eq!(still.still_at(0).frame(0).world_from_environment, then.world_from_environment);
        }
    }

    #[test]
    fn lights_stay_where_they_were() {
        let mut scene = builtin::scene("one-sphere").unwrap();
        let light = SphereLight { center: Vec3::ONE, radius: 0.5, radiance: Vec3::X };
        let moved = Pose { scale: 3.0, ..Pose::from_translation(Vec3::Z) };
        scene.lights = vec![(light, Motion::Keyframes(vec![(0.0, Pose::IDENTITY), (0.5, moved)]))];
        assert_eq!(scene.still_at(6).frame(0).lights, scene.frame(6).lights);
    }
}
