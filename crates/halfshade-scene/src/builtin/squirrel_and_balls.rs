//! A squirrel and four balls sliding down an inclined box ([Guerrero2007, 6]: 21k vertices, 14 leaf spheres, 25
//! clusters).

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, wave};
use super::daylight;
use super::ground::ground;
use super::implicit::{Body, smooth_path};
use super::lathe::{ProfilePoint, lathe};
use super::polygonize::polygonize;
use crate::{Camera, Mesh, Motion, Object, Pose, Scene};
use glam::{DQuat, Quat, Vec3};
use std::f32::consts::FRAC_PI_3;
use std::f64::consts::PI;

/// Chosen for the vertex count.
const CELL: f64 = 0.0256;
/// Objects stay this high above the box, so that no two faces coincide.
const GAP: f32 = 0.004;
/// The box falls by this angle along +X.
const SLOPE_DEGREES: f32 = 14.0;
/// Acceleration down the slope in m/s². All rolling balls share one, whatever their size; it is slower than a real one
/// so that four seconds fit on the box.
const ACCELERATION: f64 = 0.16;

/// A ball: radius, where it starts on the slope (along the fall, across it), its speed there in m/s, and its colours.
struct RollingBall {
    name: &'static str,
    radius: f32,
    start: [f32; 2],
    speed: f64,
    colors: [[f32; 3]; 2],
}

const BALLS: [RollingBall; 4] = [
    RollingBall {
        name: "red ball",
        radius: 0.42,
        start: [-1.55, -0.98],
        speed: 0.42,
        colors: [[0.78, 0.10, 0.08], [0.85, 0.82, 0.76]],
    },
    RollingBall {
        name: "blue ball",
        radius: 0.24,
        start: [-1.9, 0.80],
        speed: 0.62,
        colors: [[0.07, 0.22, 0.62], [0.88, 0.70, 0.10]],
    },
    RollingBall {
        name: "green ball",
        radius: 0.33,
        start: [-0.35, 1.44],
        speed: 0.22,
        colors: [[0.10, 0.45, 0.20], [0.86, 0.86, 0.82]],
    },
    RollingBall {
        name: "orange ball",
        radius: 0.20,
        start: [-0.60, 0.10],
        speed: 0.36,
        colors: [[0.88, 0.38, 0.05], [0.20, 0.10, 0.35]],
    },
];

/// The scene.
pub(super) fn scene() -> Scene {
    let ground_half_size = Vec3::new(2.7, 0.15, 1.9);
    let slope = Pose {
        rotation: Quat::from_rotation_z(-SLOPE_DEGREES.to_radians()),
        ..Pose::from_translation(Vec3::new(0.0, 0.75, 0.0))
    };
    let mut objects = vec![
        Object {
            name: "inclined box".into(),
            motion: Motion::Still(Pose::from_translation(Vec3::new(0.0, -ground_half_size.y, 0.0)).then(&slope)),
            ..ground(ground_half_size, [92, 66], Vec3::new(0.60, 0.56, 0.50), 5)
        },
        Object::new("squirrel", squirrel_mesh()).sphere_count(10).cluster_count(12).motion(keyframes(|time| {
            let along = -1.45 + travelled(0.30, time) as f32;
            let on_slope = Pose {
                rotation: Quat::from_rotation_y(-0.25 + 0.2 * wave(time, 1.5, 0.0)),
                ..Pose::from_translation(Vec3::new(along, GAP, 0.05 * wave(time, 1.5, 0.25)))
            };
            on_slope.then(&slope)
        })),
    ];
    objects.extend(BALLS.iter().map(|ball| {
        Object::new(ball.name, ball_mesh(ball)).sphere_count(1).cluster_count(2).motion(keyframes(|time| {
            let distance = travelled(ball.speed, time);
            let place = Vec3::new(ball.start[0] + distance as f32, ball.radius + GAP, ball.start[1]);
            // Rolling along +X turns around -Z, by the distance over the radius.
            let rolled = Quat::from_rotation_z((-distance / f64::from(ball.radius)) as f32);
            let aslant = Quat::from_rotation_x(0.6 + ball.start[1]);
            let on_slope = Pose { scale: ball.radius, rotation: rolled * aslant, translation: place };
            on_slope.then(&slope)
        }))
    }));
    Scene {
        camera: Camera {
            eye: Vec3::new(2.7, 2.5, 5.0),
            target: Vec3::new(0.2, 0.85, 0.1),
            vertical_fov_degrees: 37.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("squirrel-and-balls", objects, daylight::clear_sky(33.0, -118.0))
    }
}

/// Metres that something of initial `speed` has come after so many seconds.
fn travelled(speed: f64, time_secs: f64) -> f64 {
    speed * time_secs + 0.5 * ACCELERATION * time_secs * time_secs
}

/// The red ball, which falls in another scene.
#[cfg(feature = "physics")]
pub(super) fn beach_ball() -> Mesh {
    ball_mesh(&BALLS[0])
}

/// A ball of radius 1 in six sectors of alternating colour, with a cap on both ends.
///
/// Rings and segments instead of an icosphere, so that vertices lie along the sectors' borders.
fn ball_mesh(ball: &RollingBall) -> Mesh {
    const RINGS: usize = 28;
    const SEGMENTS: usize = 36;
    let profile: Vec<_> = (0..=RINGS)
        .map(|ring| {
            let (sin, cos) = (PI * ring as f64 / RINGS as f64).sin_cos();
            ProfilePoint::smooth(if ring % RINGS == 0 { 0.0 } else { sin as f32 }, -cos as f32)
        })
        .collect();
    let mut mesh = lathe(&profile, SEGMENTS);
    let color = |p: &Vec3| {
        // Half a segment's turn: a vertex lies in the middle of its colour, never on a border.
        let sector = (p.z.atan2(p.x) / FRAC_PI_3 + 3.0 / SEGMENTS as f32).floor() as i32;
        Vec3::from(ball.colors[usize::from(p.y.abs() > 0.97 || sector.rem_euclid(2) == 1)])
    };
    mesh.colors = mesh.positions.iter().map(color).collect();
    mesh
}

/// The squirrel as fine as it needs to be: coarser, its fur folds over.
pub(super) fn squirrel_mesh() -> Mesh {
    polygonize(&squirrel(), CELL)
}

/// A red squirrel that sits with a nut in its hands, looks along +X and rests on y = 0.
fn squirrel() -> Body {
    let red = Vec3::new(0.52, 0.20, 0.07);
    let dark_red = Vec3::new(0.38, 0.12, 0.04);
    let cream = Vec3::new(0.85, 0.74, 0.56);
    let black = Vec3::splat(0.02);
    let nut = Vec3::new(0.45, 0.27, 0.10);
    let still = DQuat::IDENTITY;
    let tilt = DQuat::from_rotation_z;
    let tail = smooth_path(&[
        [-0.16, 0.14, 0.0, 0.09],
        [-0.36, 0.13, 0.0, 0.12],
        [-0.57, 0.26, 0.0, 0.17],
        [-0.62, 0.52, 0.0, 0.20],
        [-0.50, 0.80, 0.0, 0.21],
        [-0.45, 1.06, 0.0, 0.20],
        [-0.58, 1.25, 0.0, 0.17],
        [-0.77, 1.27, 0.0, 0.13],
        [-0.87, 1.14, 0.0, 0.08],
    ]);
    let ear = smooth_path(&[
        [0.13, 0.99, 0.09, 0.085],
        [0.11, 1.08, 0.115, 0.070],
        [0.08, 1.17, 0.130, 0.048],
        [0.05, 1.25, 0.138, 0.028],
    ]);
    let arm = smooth_path(&[
        [0.12, 0.62, 0.14, 0.085],
        [0.23, 0.52, 0.195, 0.070],
        [0.34, 0.53, 0.155, 0.058],
        [0.42, 0.59, 0.07, 0.052],
    ]);
    Body::new(0.02)
        .ellipsoid([-0.02, 0.34, 0.0], [0.27, 0.34, 0.25], tilt(-0.12), 0.0, red)
        .ellipsoid([0.09, 0.56, 0.0], [0.20, 0.26, 0.19], tilt(-0.15), 0.12, red)
        .ellipsoid([0.15, 0.42, 0.0], [0.14, 0.30, 0.15], tilt(-0.10), 0.06, cream)
        .ellipsoid([0.18, 0.90, 0.0], [0.21, 0.185, 0.18], tilt(-0.15), 0.07, red)
        .ellipsoid_pair([0.25, 0.845, 0.095], [0.115, 0.10, 0.095], still, 0.05, red)
        .ellipsoid([0.36, 0.855, 0.0], [0.115, 0.08, 0.09], tilt(-0.15), 0.06, cream)
        .sphere([0.472, 0.865, 0.0], 0.035, 0.02, black)
        .tube_pair(&ear, 0.05, dark_red)
        .ellipsoid_pair([0.295, 0.945, 0.128], [0.045, 0.05, 0.04], still, 0.02, black)
        .ellipsoid_pair([0.03, 0.19, 0.20], [0.22, 0.19, 0.115], tilt(0.25), 0.04, red)
        .ellipsoid_pair([0.24, 0.052, 0.17], [0.19, 0.055, 0.075], still, 0.03, dark_red)
        .tube_pair(&arm, 0.09, dark_red)
        .ellipsoid([0.46, 0.62, 0.0], [0.075, 0.09, 0.075], tilt(-0.3), 0.03, nut)
        .tube(&tail, 0.06, dark_red)
        .flat_base(0.0, 0.04)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;

    #[test]
    fn the_squirrel_is_solid_and_its_vertices_lie_on_it() {
        let (mesh, squirrel) = (&built("squirrel-and-balls").objects[1].mesh, squirrel());
        check_solid(mesh);
        assert!(mesh.positions.iter().all(|p| squirrel.sample(p.as_dvec3()).value.abs() < 1e-6));
    }

    #[test]
    fn nobody_runs_into_anybody() {
        let scene = built("squirrel-and-balls");
        for index in 0..scene.frame_count {
            let poses = scene.frame(index).world_from_object;
            let squirrel_mesh = &scene.objects[1].mesh;
            for (i, a) in poses.iter().enumerate().skip(2) {
                let nearest = squirrel_mesh
                    .positions
                    .iter()
                    .step_by(3)
                    .map(|&p| poses[1].transform_point(p).distance(a.translation) - a.scale)
                    .fold(f32::INFINITY, f32::min);
                assert!(nearest > 0.03, "{} at frame {index}: {nearest}", scene.objects[i].name);
                for (j, b) in poses.iter().enumerate().skip(i + 1) {
                    let room = a.translation.distance(b.translation) - a.scale - b.scale;
                    assert!(room > 0.03, "objects {i} and {j} at frame {index}: {room}");
                }
            }
        }
    }

    #[test]
    fn balls_roll_without_slipping() {
        let scene = built("squirrel-and-balls");
        let touching = |pose: &Pose| {
            // The ball's material point that touches the slope, in the ball's own space.
            let down = scene.frame(0).world_from_object[0].transform_direction(Vec3::NEG_Y);
            pose.rotation.conjugate() * down
        };
        for time in [0.0, 1.0, 2.5, 3.5] {
            for object in &scene.objects[2..] {
                // Over a keyframe's span, the point of contact hardly moves while the centre does.
                let (before, after) = (object.motion.at(time), object.motion.at(time + 0.02));
                let contact = touching(&before);
                let slipped = before.transform_point(contact).distance(after.transform_point(contact));
                let moved = before.translation.distance(after.translation);
                assert!(moved > 0.003 && slipped < 0.05 * moved, "{}: {slipped} of {moved}", object.name);
            }
        }
    }
}
