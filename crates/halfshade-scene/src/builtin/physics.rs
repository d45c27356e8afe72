//! Movements by rigid-body simulation: bodies fall, roll, hit one another and come to rest; every frame is a keyframe.
//!
//! The engine is rapier, built so that it gives the same bits on every machine. Bodies collide as convex pieces and not
//! as their meshes, which would be slow and could get caught in one another: a body that isn't convex is several hulls.

use crate::{Mesh, Motion, Pose};
use glam::Vec3;
use rapier3d::prelude::{
    ColliderBuilder, PhysicsWorld, Pose as RapierPose, RigidBodyBuilder, Rotation, SharedShape, Vector,
};
use std::collections::BTreeMap;

/// Steps of the simulation per frame.
const STEPS_PER_FRAME: usize = 4;
/// Bodies keep twice this distance, in metres, so that no two faces coincide though pieces only resemble meshes.
const SKIN: f32 = 0.004;
/// A hull keeps the vertices that are outermost along so many directions: those of an icosahedron with cut edges.
const HULL_DIRECTIONS: usize = 5;
/// Hulls lie on a grid of this many points per metre. Meshes are made with the platform's sine: its last bit must not
/// decide how a heap tumbles.
const GRID: f32 = 4096.0;

/// A convex piece of a body, in object space.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    /// A sphere about the origin.
    Sphere(f32),
    /// The convex hull of points.
    Hull(Vec<Vec3>),
}

/// How surfaces meet, for a whole simulation.
pub(super) struct Contact {
    /// Coulomb's coefficient.
    pub(super) friction: f32,
    /// Part of their speed that bodies keep when they bounce.
    pub(super) restitution: f32,
}

/// A body and how it starts.
pub(super) struct RigidBody {
    /// Shape in object space.
    pub(super) pieces: Vec<Piece>,
    /// Start; the scale stays.
    pub(super) start: Pose,
    /// Velocity in m/s.
    pub(super) velocity: Vec3,
    /// Around the axis along this vector, in radians per second.
    pub(super) spin: Vec3,
    /// Mass in kilograms.
    pub(super) mass: f32,
    /// Decay of spin per second: stands for the resistance to rolling, which the engine doesn't know.
    pub(super) rolling_resistance: f32,
}

impl Piece {
    /// One hull for every part of a mesh: a triangle belongs to the part that its middle is in.
    ///
    /// Neighbouring parts share the vertices between them, so that their hulls leave no gap.
    pub(super) fn hulls(mesh: &Mesh, part_at: impl Fn(Vec3) -> usize) -> Vec<Self> {
        let mut parts: BTreeMap<usize, Vec<Vec3>> = BTreeMap::new();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            parts.entry(part_at(middle)).or_default().extend(corners);
        }
        parts.values().map(|points| Self::Hull(outermost(points))).collect()
    }

    fn shape(&self, scale: f32) -> SharedShape {
        match self {
            Self::Sphere(radius) => SharedShape::ball(scale * radius),
            Self::Hull(points) => {
                let points: Vec<Vector> = points.iter().map(|&p| vector(scale * (p * GRID).round() / GRID)).collect();
                SharedShape::convex_hull(&points).expect("a piece has a volume")
            }
        }
    }
}

/// The points that are farthest along some direction.
fn outermost(points: &[Vec3]) -> Vec<Vec3> {
    let directions = super::shapes::sphere(HULL_DIRECTIONS).positions;
    let farthest = |direction: &Vec3| {
        points.iter().copied().max_by(|a, b| a.dot(*direction).total_cmp(&b.dot(*direction))).unwrap_or_default()
    };
    let mut kept: Vec<Vec3> = directions.iter().map(farthest).collect();
    kept.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap_or(std::cmp::Ordering::Equal));
    kept.dedup();
    kept
}

/// Motions of `bodies` among `obstacles`, which stand still in world space, under gravity; in the order of the bodies.
pub(super) fn simulate(
    obstacles: &[Piece],
    bodies: &[RigidBody],
    contact: &Contact,
    frames_per_sec: f64,
    frame_count: usize,
) -> Vec<Motion> {
    let mut world = PhysicsWorld::default();
    world.integration_parameters.dt = (1.0 / (frames_per_sec * STEPS_PER_FRAME as f64)) as f32;
    let collider = |shape: SharedShape| {
        ColliderBuilder::new(shape).friction(contact.friction).restitution(contact.restitution).contact_skin(SKIN)
    };
    for obstacle in obstacles {
        world.insert_collider(collider(obstacle.shape(1.0)), None);
    }
    let handles: Vec<_> = bodies
        .iter()
        .map(|body| {
            let Pose { scale, rotation, translation } = body.start;
            let start = RapierPose::from_parts(vector(translation), Rotation::from_array(rotation.to_array()));
            let shape = match &body.pieces[..] {
                [piece] => piece.shape(scale),
                pieces => {
                    let shapes = pieces.iter().map(|piece| (RapierPose::IDENTITY, piece.shape(scale)));
                    SharedShape::compound(shapes.collect())
                }
            };
            let rigid_body = RigidBodyBuilder::dynamic()
                .pose(start)
                .linvel(vector(body.velocity))
                .angvel(vector(body.spin))
                .angular_damping(body.rolling_resistance);
            world.insert(rigid_body, collider(shape).mass(body.mass)).0
        })
        .collect();

    let mut keys: Vec<Vec<(f64, Pose)>> = vec![Vec::with_capacity(frame_count); bodies.len()];
    for frame in 0..frame_count {
        for ((keys, body), &handle) in keys.iter_mut().zip(bodies).zip(&handles) {
            let RapierPose { rotation, translation, .. } = *world.bodies[handle].position();
            let pose = Pose {
                scale: body.start.scale,
                rotation: glam::Quat::from_array(rotation.to_array()).normalize(),
                translation: Vec3::from_array(translation.to_array()),
            };
            keys.push((frame as f64 / frames_per_sec, pose));
        }
        (0..STEPS_PER_FRAME).for_each(|_| world.step());
    }
    keys.into_iter().map(Motion::Keyframes).collect()
}

/// The engine has a version of glam of its own.
fn vector(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;

    const CONTACT: Contact = Contact { friction: 0.5, restitution: 0.0 };

    fn dropped(pieces: Vec<Piece>) -> Motion {
        let ground = shapes::cuboid(Vec3::new(3.0, 0.5, 3.0), [1; 3]);
        let ground: Vec<Vec3> = ground.positions.iter().map(|&p| p - 0.5 * Vec3::Y).collect();
        let body = RigidBody {
            pieces,
            start: Pose { scale: 0.5, ..Pose::from_translation(Vec3::Y) },
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            mass: 1.0,
            rolling_resistance: 1.0,
        };
        simulate(&[Piece::Hull(ground)], &[body], &CONTACT, 60.0, 120).remove(0)
    }

    #[test]
    fn a_body_falls_freely_and_rests_on_the_ground_with_a_gap() {
        for pieces in [
            vec![Piece::Sphere(0.5)],
            Piece::hulls(&shapes::cuboid(Vec3::splat(0.5), [2; 3]), |p| usize::from(p.x > 0.0)),
        ] {
            let motion = dropped(pieces);
            let fallen = 1.0 - motion.at(0.3).translation.y;
            assert!((fallen / (0.5 * 9.81 * 0.09) - 1.0).abs() < 0.05, "{fallen}");
            let rest = motion.at(9.0).translation;
            assert!((0.25 + 0.001..0.25 + 3.0 * SKIN).contains(&rest.y) && rest.with_y(0.0).length() < 0.1, "{rest}");
        }
    }

    #[test]
    fn simulation_repeats_bit_by_bit() {
        let fall = || dropped(Piece::hulls(&shapes::torus(0.4, 0.2, 24, 12), |p| usize::from(p.x > 0.0)));
        assert_eq!(fall(), fall());
    }

    #[test]
    fn hulls_keep_what_is_outermost() {
        let Piece::Hull(points) = Piece::hulls(&shapes::box_mesh(6), |_| 0).remove(0) else { panic!("no hull") };
        let corners = points.iter().filter(|p| p.abs() == Vec3::ONE).count();
        assert!(corners == 8 && points.len() < 16, "{points:?}");
    }
}
