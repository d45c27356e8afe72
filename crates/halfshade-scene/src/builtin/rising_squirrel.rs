//! A squirrel that rises from a plane under one spherical light.
//!
//! After [Meunier2009, figure 17], which shows a rabbit at three heights: 16,384 points on the plane, 64 blocker
//! spheres. The shadow softens and fades with the height. Every frame is a height, equally far from the one before.

use super::choreography::{DURATION_SECS, FRAME_COUNT, FRAMES_PER_SEC, keyframes};
use super::{shapes, squirrel_and_balls};
use crate::{Camera, Environment, Motion, Object, Pose, Scene, SphereLight};
use glam::Vec3;

/// Vertices along a side of the plane.
const SIDE: usize = 128;
const HALF_SIZE: f32 = 2.5;
const SIZE: f32 = 0.8;
/// Above the plane in the first frame, so that no two faces coincide.
const GAP: f32 = 0.004;
/// Speed of its rise in m/s.
const SPEED: f32 = 0.3;

/// The scene.
pub(super) fn scene() -> Scene {
    let plane = Object::new("plane", shapes::plane(SIDE - 1))
        .albedo(Vec3::splat(0.75))
        .cluster_count(16)
        .pose(Pose { scale: HALF_SIZE, ..Pose::IDENTITY });
    let squirrel = Object::new("squirrel", squirrel_and_balls::squirrel_mesh())
        .sphere_count(64)
        .cluster_count(12)
        .motion(keyframes(|time| Pose { scale: SIZE, ..Pose::from_translation(Vec3::new(0.2, height_at(time), 0.1)) }));
    let light = SphereLight { center: Vec3::new(-1.2, 4.0, 1.0), radius: 0.4, radiance: Vec3::splat(40.0) };
    Scene {
        lights: vec![(light, Motion::Still(Pose::IDENTITY))],
        camera: Camera {
            eye: Vec3::new(0.6, 3.2, 5.0),
            target: Vec3::new(0.1, 0.6, 0.0),
            vertical_fov_degrees: 36.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("rising-squirrel", vec![plane, squirrel], Environment::constant(Vec3::ZERO))
    }
}

fn height_at(time_secs: f64) -> f32 {
    GAP + SPEED * time_secs.min(DURATION_SECS) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;

    #[test]
    fn counts_are_those_of_meunier_and_every_frame_is_higher() {
        let scene = built("rising-squirrel");
        let [plane, squirrel] = &scene.objects[..] else { panic!("two objects") };
        assert_eq!((plane.mesh.positions.len(), squirrel.sphere_count), (16_384, 64));
        check_solid(&squirrel.mesh);
        let height = |frame: usize| scene.frame(frame).world_from_object[1].translation.y;
        let step = SPEED / FRAMES_PER_SEC as f32;
        for frame in 1..scene.frame_count {
            assert!((height(frame) - height(frame - 1) - step).abs() < 1e-4, "frame {frame}");
        }
    }

    /// A shadow at any height needs the whole light seen from the plane, and the object between.
    #[test]
    fn the_squirrel_stays_below_the_light() {
        let scene = built("rising-squirrel");
        let (_, high) = scene.objects[1].mesh.bounds().unwrap();
        let top = scene.frame(scene.frame_count - 1).world_from_object[1].transform_point(high).y;
        let light = scene.frame(0).lights[0];
        assert!(top > 2.0 && top < light.center.y - light.radius, "{top}");
    }
}
