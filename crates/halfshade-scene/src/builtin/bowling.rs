//! A ball rolls down a lane into ten pins ([Tamura2006, 6, figure 10]: 15 objects, 41,340 vertices).
//!
//! Lengths and masses are those of the sport. The lane and its gutters lie on a floor; what stands still receives only.

use super::ground::ground;
use super::gutter::{self, gutter};
use super::lathe::lathe;
use super::physics::{Contact, Piece, RigidBody, simulate};
use super::polish::polished;
use super::profile::spline_profile;
use super::{choreography, shapes, studio};
use crate::{Camera, Material, Mesh, Motion, Object, Pose, Scene, SphereLight};
use glam::{Quat, Vec2, Vec3};
use rand::{RngExt, SeedableRng};
use std::f32::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// Real time: a frame is a sixtieth of a second.
const FRAMES_PER_SEC: f64 = 60.0;
const FRAME_COUNT: usize = 150;

const LANE_HALF_WIDTH: f32 = 0.525;
/// The lane's near and far end.
const LANE_ENDS: [f32; 2] = [1.55, -1.95];
/// The floor's height; the lane's is 0.
const FLOOR: f32 = -0.07;
/// Objects that stand still keep this distance, so that no two faces coincide.
const GAP: f32 = 0.004;

const BALL_RADIUS: f32 = 0.108;
const BALL_MASS: f32 = 6.8;
/// Speed of the ball in m/s: a child's throw, so that it doesn't cross the picture in a blink.
const BALL_SPEED: f32 = 3.6;
const BALL_START: Vec2 = Vec2::new(0.16, 1.2);
/// Aim of the ball: the pocket to the right of the head pin.
const BALL_AIM: Vec2 = Vec2::new(0.05, HEAD_PIN);

/// Half the length of the cushion behind the pins.
const CUSHION_HALF_LENGTH: f32 = 0.8;

/// The cushion's radius, as a fraction of half its length.
const CUSHION_SLIMNESS: f32 = 0.2;

/// Place of the head pin along the lane.
const HEAD_PIN: f32 = -0.75;
/// Distance between neighbouring pins.
const PIN_SPACING: f32 = 0.3048;
const PIN_MASS: f32 = 1.55;

/// Radius and height of a pin's control points, in inches as in the rules.
const PIN: [[f64; 2]; 17] = [
    [0.0, 0.0],
    [0.90, 0.0],
    [1.10, 0.10],
    [1.42, 0.75],
    [1.97, 2.25],
    [2.28, 3.375],
    [2.42, 4.5],
    [2.32, 5.875],
    [1.87, 7.25],
    [1.20, 8.625],
    [0.93, 9.6],
    [0.92, 10.6],
    [1.09, 11.75],
    [1.27, 12.7],
    [1.30, 13.7],
    [0.95, 14.85],
    [0.0, 15.0],
];
/// Where a pin is cut into convex pieces: its outline bends inward around the neck.
pub(super) const PIN_NECKS: &[f32] = &[0.17, 0.20, 0.225, 0.25, 0.275, 0.30];
const METRES_PER_INCH: f64 = 0.0254;

/// How surfaces meet.
const CONTACT: Contact = Contact { friction: 0.3, restitution: 0.4 };

pub(super) fn scene() -> Scene {
    let mut objects = vec![floor(), lane(), gutters()];
    let (ball, cushion, pin) = (Arc::new(ball()), Arc::new(cushion()), Arc::new(pin()));
    let mut bodies = vec![rolling_ball(), lying_cushion(&cushion)];
    bodies.extend(standing_pins(&pin));
    let motions = simulate(&obstacles(), &bodies, &CONTACT, FRAMES_PER_SEC, FRAME_COUNT);
    objects.extend(motions.into_iter().enumerate().map(|(number, motion)| {
        let (name, mesh, sphere_count) = match number {
            0 => ("ball".into(), &ball, 1),
            1 => ("cushion".into(), &cushion, 10),
            _ => (format!("pin {}", number - 1), &pin, 6),
        };
        Object::new(name, mesh.clone())
            // As in the paper, whose ball becomes glossy.
            .material(if number == 0 { polished(Vec3::ONE) } else { Material::default() })
            .sphere_count(sphere_count)
            .cluster_count(2)
            .motion(motion)
    }));
    Scene {
        lights: lights(),
        camera: Camera {
            eye: Vec3::new(0.92, 0.95, 1.15),
            target: Vec3::new(0.0, 0.04, -1.0),
            vertical_fov_degrees: 32.0,
            resolution: [900, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("bowling", objects, studio::studio().scaled(0.45))
    }
}

fn floor() -> Object {
    let half_size = Vec3::new(1.5, 0.1, 2.4);
    Object {
        name: "floor".into(),
        motion: Motion::Still(Pose::from_translation(Vec3::new(0.0, FLOOR - half_size.y, -0.75))),
        ..ground(half_size, [52, 84], Vec3::new(0.16, 0.20, 0.30), 6)
    }
}

/// Boards along the lane, every one of another shade of maple.
fn lane() -> Object {
    const BOARDS: usize = 39;
    let bottom = FLOOR + GAP;
    let half_size = Vec3::new(LANE_HALF_WIDTH, -0.5 * bottom, 0.5 * (LANE_ENDS[0] - LANE_ENDS[1]));
    let mut mesh = shapes::slab(half_size, [2 * BOARDS, 84]);
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(39);
    let shades: Vec<f32> = (0..=BOARDS).map(|_| random.random_range(0.72..1.0)).collect();
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| {
            let board = (p.x / LANE_HALF_WIDTH + 1.0) * 0.5 * BOARDS as f32;
            Vec3::new(0.80, 0.56, 0.31) * shades[board as usize]
        })
        .collect();
    Object::new("lane", mesh).cluster_count(6).pose(Pose::from_translation(Vec3::new(
        0.0,
        bottom + half_size.y,
        lane_middle(),
    )))
}

fn lane_middle() -> f32 {
    0.5 * (LANE_ENDS[0] + LANE_ENDS[1])
}

/// Both gutters.
fn gutters() -> Object {
    let mut mesh = Mesh::default();
    for pose in [gutter_pose(-1.0), gutter_pose(1.0)] {
        let one = gutter(0.5 * (LANE_ENDS[0] - LANE_ENDS[1]), 56);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(one.positions.iter().map(|&p| pose.transform_point(p)));
        mesh.normals.extend(one.normals);
        mesh.triangles.extend(one.triangles.iter().map(|t| t.map(|vertex| first + vertex)));
    }
    Object::new("gutters", mesh).albedo(Vec3::new(0.20, 0.22, 0.26)).cluster_count(6)
}

fn gutter_pose(side: f32) -> Pose {
    let beside = LANE_HALF_WIDTH + GAP + gutter::HALF_WIDTH;
    Pose::from_translation(Vec3::new(side * beside, FLOOR + GAP, lane_middle()))
}

/// Bodies that stand still, for the simulation.
fn obstacles() -> Vec<Piece> {
    let block = |low: Vec3, high: Vec3| {
        Piece::Hull(
            (0..8).map(|i| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), low, high)).collect(),
        )
    };
    let mut obstacles = vec![
        block(Vec3::new(-4.0, FLOOR - 1.0, -6.0), Vec3::new(4.0, FLOOR, 4.0)),
        block(Vec3::new(-LANE_HALF_WIDTH, FLOOR, LANE_ENDS[1]), Vec3::new(LANE_HALF_WIDTH, 0.0, LANE_ENDS[0])),
    ];
    for side in [-1.0, 1.0] {
        let pose = gutter_pose(side);
        let half_length = 0.5 * (LANE_ENDS[0] - LANE_ENDS[1]);
        obstacles.extend(
            gutter::convex_parts(half_length)
                .into_iter()
                .map(|part| Piece::Hull(part.into_iter().map(|point| pose.transform_point(point)).collect())),
        );
    }
    obstacles
}

fn rolling_ball() -> RigidBody {
    let along = (BALL_AIM - BALL_START).normalize() * BALL_SPEED;
    let velocity = Vec3::new(along.x, 0.0, along.y);
    RigidBody {
        pieces: vec![Piece::Sphere(1.0)],
        start: Pose {
            scale: BALL_RADIUS,
            rotation: Quat::from_rotation_x(0.5),
            translation: Vec3::new(BALL_START.x, BALL_RADIUS + GAP, BALL_START.y),
        },
        velocity,
        spin: Vec3::Y.cross(velocity) / BALL_RADIUS,
        mass: BALL_MASS,
        rolling_resistance: 0.0,
    }
}

/// The cushion that stops the ball: so heavy that it gives way a little, and too soft to roll.
fn lying_cushion(mesh: &Mesh) -> RigidBody {
    RigidBody {
        pieces: Piece::hulls(mesh, |_| 0),
        start: Pose {
            scale: CUSHION_HALF_LENGTH,
            rotation: Quat::from_rotation_z(FRAC_PI_2),
            translation: Vec3::new(0.0, FLOOR + CUSHION_HALF_LENGTH * CUSHION_SLIMNESS + GAP, -2.45),
        },
        velocity: Vec3::ZERO,
        spin: Vec3::ZERO,
        mass: 60.0,
        rolling_resistance: 30.0,
    }
}

/// Four rows, the head pin in front.
fn standing_pins(mesh: &Mesh) -> Vec<RigidBody> {
    let pieces = Piece::hulls(mesh, |p| PIN_NECKS.iter().filter(|&&height| p.y > height).count());
    let mut pins = Vec::new();
    for row in 0..4 {
        for place in 0..=row {
            let across = (place as f32 - 0.5 * row as f32) * PIN_SPACING;
            let along = HEAD_PIN - row as f32 * PIN_SPACING * 0.75f32.sqrt();
            pins.push(RigidBody {
                pieces: pieces.clone(),
                start: upright_at(Vec3::new(across, GAP, along)),
                velocity: Vec3::ZERO,
                spin: Vec3::ZERO,
                mass: PIN_MASS,
                rolling_resistance: 3.0,
            });
        }
    }
    pins
}

fn upright_at(place: Vec3) -> Pose {
    // Ten pins, ten ways to turn the same mesh.
    choreography::upright(place, 7.0 * place.x + 3.0 * place.z, 1.0)
}

/// White with two red rings around the neck; it stands on y = 0.
pub(super) fn pin() -> Mesh {
    const PROFILE_POINTS: usize = 48;
    const SEGMENTS: usize = 44;
    let controls = PIN.map(|[radius, height]| [radius * METRES_PER_INCH, height * METRES_PER_INCH]);
    let mut mesh = lathe(&spline_profile(&controls, PROFILE_POINTS), SEGMENTS);
    let ringed = |height: f32| (0.230..0.243).contains(&height) || (0.256..0.269).contains(&height);
    let (white, red) = (Vec3::new(0.88, 0.87, 0.84), Vec3::new(0.72, 0.03, 0.04));
    mesh.colors = mesh.positions.iter().map(|p| if ringed(p.y) { red } else { white }).collect();
    mesh
}

/// A striped roll from y = -1 to 1.
fn cushion() -> Mesh {
    let mut mesh = shapes::capsule(CUSHION_SLIMNESS, 40);
    let (canvas, stripe) = (Vec3::new(0.72, 0.66, 0.54), Vec3::new(0.10, 0.30, 0.34));
    let striped = |y: f32| (3.5 * y).rem_euclid(1.0) > 0.6;
    mesh.colors = mesh.positions.iter().map(|p| if striped(p.y) { stripe } else { canvas }).collect();
    mesh
}

/// A ball of radius 1, swirled in two blues, with three finger holes painted on.
fn ball() -> Mesh {
    let mut mesh = shapes::sphere(16);
    let holes =
        [Vec3::new(0.16, 0.96, 0.0), Vec3::new(-0.16, 0.96, 0.0), Vec3::new(0.0, 0.86, 0.48)].map(Vec3::normalize);
    let (deep, light) = (Vec3::new(0.03, 0.10, 0.36), Vec3::new(0.20, 0.50, 0.72));
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| {
            let swirl = (4.0 * p.y + 2.0 * (3.0 * p.x).sin() + 2.0 * (2.5 * p.z + 1.0).sin()).sin();
            let hole = holes.iter().any(|hole| hole.distance(*p) < 0.11);
            if hole { Vec3::splat(0.01) } else { deep.lerp(light, 0.5 + 0.5 * swirl) }
        })
        .collect();
    mesh
}

/// A warm lamp that follows the ball and a cool one that circles above the pins.
fn lights() -> Vec<(SphereLight, Motion)> {
    let at = |position_at: &dyn Fn(f32) -> Vec3| {
        let keys = (0..=FRAME_COUNT / 5).map(|key| {
            let time_secs = 5.0 * key as f64 / FRAMES_PER_SEC;
            (time_secs, Pose::from_translation(position_at(5.0 * key as f32 / FRAME_COUNT as f32)))
        });
        Motion::Keyframes(keys.collect())
    };
    let light = |radius, radiance| SphereLight { center: Vec3::ZERO, radius, radiance };
    vec![
        (light(0.14, Vec3::new(26.0, 19.0, 12.0)), at(&|x| Vec3::new(-0.75, 0.95, 0.9 - 1.6 * x))),
        (
            light(0.10, Vec3::new(12.0, 20.0, 34.0)),
            at(&|x| {
                let (sin, cos) = (TAU * (0.6 * x + 0.1)).sin_cos();
                Vec3::new(0.5 + 0.35 * cos, 0.95, -1.2 + 0.35 * sin)
            }),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::{built, fastest_middle};

    #[test]
    fn pins_and_cushion_are_solid_and_of_the_size_of_the_sport() {
        check_solid(&cushion());
        let pin = pin();
        check_solid(&pin);
        let (low, high) = pin.bounds().unwrap();
        assert!(low.y.abs() < 1e-3 && (high.y - 0.381).abs() < 0.005, "{low} {high}");
        assert!((high.x - low.x - 0.121).abs() < 0.003, "{low} {high}");
    }

    #[test]
    fn every_pin_falls() {
        let scene = built("bowling");
        let (first, last) = (scene.frame(0), scene.frame(scene.frame_count - 1));
        for (number, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.name.starts_with("pin")) {
            let up = |frame: &crate::Frame<'_>| (frame.world_from_object[number].rotation * Vec3::Y).y;
            assert!(up(&first) > 0.999 && up(&last) < 0.5, "{}", object.name);
        }
    }

    #[test]
    fn nothing_is_faster_than_a_pin_hit_head_on() {
        // A collision of two bodies along the line between their middles.
        let passed_on = (1.0 + CONTACT.restitution) * BALL_MASS / (BALL_MASS + PIN_MASS);
        let fastest = fastest_middle(built("bowling"));
        assert!((0.99 * BALL_SPEED..1.1 * passed_on * BALL_SPEED).contains(&fastest), "{fastest} m/s");
    }
}
