//! Two squirrels of chocolate in an open box under one spherical light.
//!
//! After [Meunier2009, figure 18], which shows two rabbits in a green box: 480,000 shaded points, which are the pixels
//! of this camera, 1,024 blocker spheres, and two lobes of reflectance everywhere. The box has a floor and three walls;
//! its front and top are open. The light hangs within, so that the walls hide nothing.

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::{shapes, squirrel_and_balls};
use crate::{Camera, Environment, Material, Mesh, Motion, Object, Pose, Reflectance, Scene, SphereLight};
use glam::{Quat, Vec3};
use std::{f32::consts::FRAC_PI_2, sync::Arc};

/// Half the width of floor and walls.
const HALF_SIZE: f32 = 2.0;
const SIZE: f32 = 0.8;
/// Above the floor, so that no two faces coincide.
const GAP: f32 = 0.004;

/// The scene.
pub(super) fn scene() -> Scene {
    let green = Material {
        reflectance: Reflectance::ModifiedPhong { specular: Vec3::splat(0.1), exponent: 12.0 },
        ..Material::new(Vec3::new(0.22, 0.5, 0.2))
    };
    let chocolate = Material {
        reflectance: Reflectance::ModifiedPhong { specular: Vec3::splat(0.25), exponent: 40.0 },
        ..Material::new(Vec3::new(0.28, 0.13, 0.06))
    };
    let face = Arc::new(shapes::plane(64));
    let side = |name: &str, center: Vec3, rotation: Quat| {
        Object::new(name, face.clone()).material(green.clone()).cluster_count(8).pose(Pose {
            scale: HALF_SIZE,
            rotation,
            translation: HALF_SIZE * center,
        })
    };
    // One colour: that of the chocolate.
    let body = Arc::new(Mesh { colors: Vec::new(), ..squirrel_and_balls::squirrel_mesh() });
    let squirrel = |name: &str, motion: Motion| {
        Object::new(name, body.clone()).material(chocolate.clone()).sphere_count(512).cluster_count(12).motion(motion)
    };
    let turning = keyframes(|time| {
        let place = Vec3::new(-0.9, GAP, 0.05 + 0.1 * wave(time, 1.0, 0.0));
        upright(place, -0.6 + 0.4 * wave(time, 1.0, 0.25), SIZE)
    });
    let sliding = keyframes(|time| {
        let place = Vec3::new(0.9 + 0.1 * wave(time, 1.0, 0.1), GAP, -0.55);
        upright(place, -2.3 + 0.3 * wave(time, 1.0, 0.0), SIZE)
    });
    let light = SphereLight { center: Vec3::new(0.4, 3.3, 0.9), radius: 0.4, radiance: Vec3::splat(30.0) };
    let objects = vec![
        side("floor", Vec3::ZERO, Quat::IDENTITY),
        side("back wall", Vec3::new(0.0, 1.0, -1.0), Quat::from_rotation_x(FRAC_PI_2)),
        side("left wall", Vec3::new(-1.0, 1.0, 0.0), Quat::from_rotation_z(-FRAC_PI_2)),
        side("right wall", Vec3::new(1.0, 1.0, 0.0), Quat::from_rotation_z(FRAC_PI_2)),
        squirrel("left squirrel", turning),
        squirrel("right squirrel", sliding),
    ];
    Scene {
        lights: vec![(light, Motion::Still(Pose::IDENTITY))],
        camera: Camera {
            eye: Vec3::new(0.0, 1.9, 2.95),
            target: Vec3::new(0.0, 0.75, -0.2),
            vertical_fov_degrees: 42.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("two-squirrels", objects, Environment::constant(Vec3::ZERO))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;

    #[test]
    fn counts_are_those_of_meunier() {
        let scene = built("two-squirrels");
        assert_eq!(scene.objects.iter().map(|object| object.sphere_count).sum::<usize>(), 1_024);
        assert_eq!(scene.camera.resolution.iter().product::<u32>(), 480_000);
        check_solid(&scene.objects[4].mesh);
        assert!(Arc::ptr_eq(&scene.objects[4].mesh, &scene.objects[5].mesh), "one sphere set for both");
        for object in &scene.objects {
            object.material.reflectance.validate(object.material.albedo).unwrap();
        }
    }

    #[test]
    fn every_pixel_shows_the_box() {
        let camera = built("two-squirrels").camera;
        let Camera { eye, resolution: [width, height], .. } = camera;
        for pixel in 0..width * height {
            let direction = camera.ray_direction((pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5);
            // Into the box through its open front, and out of it where the first of the four sides is.
            let to_front = (eye.z - HALF_SIZE) / -direction.z;
            let entry = eye + to_front * direction;
            assert!(to_front > 0.0 && entry.x.abs() < HALF_SIZE && entry.y > 0.0 && entry.y < 2.0 * HALF_SIZE);
            let distances = [
                (HALF_SIZE * direction.x.signum() - eye.x) / direction.x,
                -eye.y / direction.y,
                (-HALF_SIZE - eye.z) / direction.z,
            ];
            let nearest = distances.into_iter().filter(|distance| *distance > 0.0).fold(f32::INFINITY, f32::min);
            assert!((eye + nearest * direction).y < 2.0 * HALF_SIZE, "pixel {pixel} looks out at the top");
        }
    }

    #[test]
    fn inner_sides_face_the_light_and_squirrels_meet_nothing() {
        let scene = built("two-squirrels");
        for index in (0..scene.frame_count).step_by(5) {
            let frame = scene.frame(index);
            let (poses, light) = (&frame.world_from_object, frame.lights[0]);
            for side in &poses[..4] {
                let off = (light.center - side.translation).dot(side.transform_direction(Vec3::Y));
                assert!(off > light.radius, "the light is not within the box");
            }
            // Circles around the axes that they turn about.
            let reach = |k: usize| {
                let off_axis = |p: &Vec3| p.x.hypot(p.z);
                poses[k].scale * scene.objects[k].mesh.positions.iter().map(off_axis).fold(0.0, f32::max)
            };
            let (a, b) = (poses[4].translation, poses[5].translation);
            assert!((a - b).length() > reach(4) + reach(5) + 0.03, "frame {index}");
            for (k, place) in [(4, a), (5, b)] {
                assert!(place.x.abs().max(place.z.abs()) + reach(k) < HALF_SIZE - 0.03, "frame {index}");
            }
        }
    }
}
