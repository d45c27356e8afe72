//! Three rubber ducks close together on a ground box ([Guerrero2007, 6]: 33k vertices, 30 leaf spheres, 40 clusters).

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::daylight;
use super::ground::ground;
use super::implicit::{Body, smooth_path};
use super::polygonize::polygonize;
use crate::{Camera, Object, Scene};
use glam::{DQuat, Vec3};
use std::sync::Arc;

/// Chosen for the vertex count.
const CELL: f64 = 0.0267;
/// Ducks stay this high above the ground, so that no two faces coincide.
const GAP: f32 = 0.004;

/// A duck's place on the ground, where it looks, its size, its tint, and how it moves.
struct Duck {
    name: &'static str,
    place: [f32; 2],
    yaw: f32,
    scale: f32,
    tint: [f32; 3],
    slide: [f32; 2],
    phase: f64,
}

const DUCKS: [Duck; 3] = [
    Duck {
        name: "left duck",
        place: [-0.62, 0.20],
        yaw: -0.75,
        scale: 1.0,
        tint: [1.0, 1.0, 1.0],
        slide: [0.05, 0.05],
        phase: 0.0,
    },
    Duck {
        name: "right duck",
        place: [0.70, 0.20],
        yaw: -2.15,
        scale: 0.92,
        tint: [1.0, 0.93, 0.85],
        slide: [-0.05, 0.05],
        phase: 0.35,
    },
    Duck {
        name: "rear duck",
        place: [0.0, -1.0],
        yaw: -1.35,
        scale: 1.15,
        tint: [1.0, 0.97, 0.9],
        slide: [0.05, -0.04],
        phase: 0.7,
    },
];

/// The scene.
pub(super) fn scene() -> Scene {
    let duck = Arc::new(polygonize(&duck(), CELL));
    let mut objects = vec![ground(Vec3::new(2.1, 0.15, 1.9), [88, 80], Vec3::new(0.50, 0.58, 0.63), 7)];
    objects.extend(DUCKS.iter().map(|one| {
        Object::new(one.name, duck.clone()).albedo(one.tint.into()).sphere_count(10).cluster_count(11).motion(
            keyframes(|time| {
                let swing = wave(time, 1.0, one.phase);
                // Two hops per round; at the lowest point a duck is at rest on the ground.
                let hop = 0.04 * (1.0 - wave(time, 2.0, one.phase));
                let place =
                    Vec3::new(one.place[0] + one.slide[0] * swing, GAP + hop, one.place[1] + one.slide[1] * swing);
                upright(place, one.yaw + 0.22 * wave(time, 1.0, one.phase + 0.2), one.scale)
            }),
        )
    }));
    Scene {
        camera: Camera {
            eye: Vec3::new(0.5, 1.95, 4.4),
            target: Vec3::new(0.02, 0.48, -0.1),
            vertical_fov_degrees: 31.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("ducks", objects, daylight::clear_sky(42.0, -125.0))
    }
}

/// A rubber duck that looks along +X and stands on y = 0.
pub(super) fn duck() -> Body {
    let yellow = Vec3::new(0.92, 0.72, 0.06);
    let orange = Vec3::new(0.90, 0.30, 0.03);
    let (white, black) = (Vec3::splat(0.9), Vec3::splat(0.02));
    let still = DQuat::IDENTITY;
    let tilt = DQuat::from_rotation_z;
    let tail = smooth_path(&[
        [-0.34, 0.40, 0.0, 0.20],
        [-0.49, 0.50, 0.0, 0.15],
        [-0.60, 0.61, 0.0, 0.10],
        [-0.67, 0.75, 0.0, 0.05],
    ]);
    Body::new(0.012)
        .ellipsoid([-0.02, 0.33, 0.0], [0.58, 0.34, 0.42], tilt(-0.06), 0.0, yellow)
        .ellipsoid([0.24, 0.40, 0.0], [0.33, 0.32, 0.36], still, 0.15, yellow)
        .tube(&tail, 0.16, yellow)
        .tube(&[[0.24, 0.58, 0.0, 0.21], [0.26, 0.80, 0.0, 0.20]], 0.16, yellow)
        .sphere([0.28, 0.94, 0.0], 0.285, 0.10, yellow)
        .ellipsoid_pair(
            [-0.13, 0.45, 0.37],
            [0.33, 0.18, 0.09],
            DQuat::from_rotation_y(-0.16) * tilt(-0.30),
            0.07,
            yellow,
        )
        .ellipsoid([0.57, 0.910, 0.0], [0.165, 0.050, 0.145], tilt(0.22), 0.05, orange)
        .ellipsoid([0.54, 0.850, 0.0], [0.130, 0.045, 0.115], tilt(-0.10), 0.05, orange)
        .ellipsoid_pair([0.475, 1.035, 0.135], [0.07, 0.075, 0.065], still, 0.02, white)
        .ellipsoid_pair([0.515, 1.045, 0.155], [0.045, 0.05, 0.045], still, 0.02, black)
        .flat_base(0.0, 0.06)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;

    #[test]
    fn the_duck_is_solid_and_its_vertices_lie_on_it() {
        let (mesh, duck) = (&built("ducks").objects[1].mesh, duck());
        check_solid(mesh);
        assert!(mesh.positions.iter().all(|p| duck.sample(p.as_dvec3()).value.abs() < 1e-6));
        assert!(mesh.positions.iter().all(|p| p.y >= -1e-6));
    }

    #[test]
    fn ducks_never_touch() {
        let (scene, body) = (built("ducks"), duck());
        for index in (0..scene.frame_count).step_by(7) {
            let poses = scene.frame(index).world_from_object;
            for i in 1..poses.len() {
                for j in (1..poses.len()).filter(|&j| j != i) {
                    let into_other = poses[i].then(&poses[j].inverse());
                    for &position in scene.objects[i].mesh.positions.iter().step_by(5) {
                        let value = body.sample(into_other.transform_point(position).as_dvec3()).value;
                        assert!(value > 0.02, "duck {i} in duck {j} at frame {index}");
                    }
                }
            }
        }
    }
}
