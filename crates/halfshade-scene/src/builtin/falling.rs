//! Nineteen toys drop onto a ground box and come to rest in a heap ([Tamura2006, 6, figure 11]: 20 objects, 88,739
//! vertices).

use super::ground::ground;
use super::physics::{Contact, Piece, RigidBody, simulate};
use super::polish::polished;
use super::toys::{self, Toy};
use super::{bowling, daylight, squirrel_and_balls, statues, vases};
use crate::{Camera, Material, Mesh, Object, Pose, Scene};
use glam::{BVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Real time: a frame is a fiftieth of a second.
const FRAMES_PER_SEC: f64 = 50.0;
const FRAME_COUNT: usize = 170;

/// Toys start in layers of four around the middle, none touching another.
const PER_LAYER: usize = 4;
/// Height of the lowest layer's middle, in metres, and from layer to layer.
const LOWEST_LAYER: f32 = 0.6;
const LAYER_HEIGHT: f32 = 0.9;
/// Distance of the toys from the middle.
const REACH: f32 = 0.74;

/// The toys from the lowest to the highest: which, its size, tint and spheres.
const FALLING: [(&str, f32, [f32; 3], usize); 19] = [
    ("duck", 0.46, [1.0, 1.0, 1.0], 8),
    ("block", 1.0, [1.0, 1.0, 1.0], 8),
    ("ring", 0.95, [0.80, 0.16, 0.10], 12),
    ("gourd", 0.55, [1.0, 1.0, 1.0], 6),
    ("drum", 1.0, [1.0, 1.0, 1.0], 6),
    ("teapot", 0.68, [1.0, 1.0, 1.0], 8),
    ("knot", 0.95, [0.45, 0.16, 0.55], 16),
    ("star", 0.95, [0.90, 0.66, 0.08], 8),
    ("ball", 0.27, [1.0, 1.0, 1.0], 1),
    ("squirrel", 0.52, [1.0, 1.0, 1.0], 8),
    ("queen", 0.55, [1.0, 1.0, 1.0], 6),
    ("jack", 0.85, [1.0, 1.0, 1.0], 10),
    ("ring", 0.75, [0.10, 0.42, 0.62], 12),
    ("block", 0.8, [0.9, 0.95, 1.0], 8),
    ("pin", 2.0, [1.0, 1.0, 1.0], 6),
    ("duck", 0.38, [1.0, 0.85, 0.75], 8),
    ("star", 0.8, [0.86, 0.30, 0.26], 8),
    ("teapot", 0.55, [1.0, 0.86, 0.80], 8),
    ("bottle", 0.55, [1.0, 1.0, 1.0], 6),
];

/// Toys that shine.
const POLISHED: [&str; 3] = ["teapot", "ball", "drum"];

pub(super) fn scene() -> Scene {
    let half_size = Vec3::new(2.4, 0.15, 2.0);
    let mut objects = vec![ground(half_size, [107, 102], Vec3::new(0.56, 0.55, 0.50), 8)];
    let toys: Vec<(&str, Arc<Mesh>, Vec<Piece>)> =
        toys().into_iter().map(|(name, toy)| (name, Arc::new(toy.mesh), toy.pieces)).collect();
    let toy = |name: &str| toys.iter().find(|toy| toy.0 == name).expect("every toy that falls is made");

    let starts = starts();
    let bodies: Vec<RigidBody> = FALLING
        .iter()
        .zip(&starts)
        .map(|(&(name, scale, ..), &(start, spin))| {
            let (_, mesh, pieces) = toy(name);
            RigidBody {
                pieces: pieces.clone(),
                start: centered(mesh, Pose { scale, ..start }),
                velocity: Vec3::ZERO,
                spin,
                mass: 1.0,
                rolling_resistance: if name == "ball" { 6.0 } else { 2.5 },
            }
        })
        .collect();
    let floor = (0..8).map(|i| {
        Vec3::select(BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), Vec3::new(-9.0, -1.0, -9.0), Vec3::new(9.0, 0.0, 9.0))
    });
    let contact = Contact { friction: 0.8, restitution: 0.05 };
    let motions = simulate(&[Piece::Hull(floor.collect())], &bodies, &contact, FRAMES_PER_SEC, FRAME_COUNT);
    objects.extend(FALLING.iter().zip(motions).enumerate().map(|(number, (&(name, _, tint, spheres), motion))| {
        Object::new(format!("{name} {}", number + 1), toy(name).1.clone())
            .material(if POLISHED.contains(&name) { polished(tint.into()) } else { Material::new(tint.into()) })
            .sphere_count(spheres)
            .cluster_count(4)
            .motion(motion)
    }));
    Scene {
        camera: Camera {
            eye: Vec3::new(0.6, 2.6, 5.2),
            target: Vec3::new(0.0, 0.62, 0.0),
            vertical_fov_degrees: 32.0,
            resolution: [900, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("falling", objects, daylight::clear_sky(48.0, -115.0))
    }
}

fn toys() -> Vec<(&'static str, Toy)> {
    vec![
        ("duck", toys::duck()),
        ("block", toys::block()),
        ("ring", toys::ring()),
        ("gourd", Toy::turned(turned_vase("gourd"), &[0.68, 0.73, 0.78, 1.06, 1.16, 1.24])),
        ("drum", toys::drum()),
        ("teapot", toys::teapot()),
        ("knot", toys::knot()),
        ("star", toys::star()),
        ("ball", Toy::turned(squirrel_and_balls::beach_ball(), &[])),
        ("squirrel", toys::squirrel()),
        ("queen", Toy::turned(statues::queen(), &[0.10, 0.17, 0.30, 0.45, 0.95, 1.04, 1.16, 1.30, 1.54])),
        ("jack", toys::jack()),
        ("pin", Toy::turned(bowling::pin(), bowling::PIN_NECKS)),
        ("bottle", Toy::turned(turned_vase("bottle"), &[0.48, 0.58, 0.66, 1.14])),
    ]
}

fn turned_vase(name: &str) -> Mesh {
    vases::vase(name).expect("it stands in the scene of vases")
}

/// The pose that has the middle of a mesh where `pose` has the origin.
fn centered(mesh: &Mesh, pose: Pose) -> Pose {
    let (low, high) = mesh.bounds().unwrap_or_default();
    Pose { translation: pose.translation - pose.scale * (pose.rotation * (0.5 * (low + high))), ..pose }
}

/// Where the middle of each body starts, how it is turned, and its spin.
fn starts() -> Vec<(Pose, Vec3)> {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    (0..FALLING.len())
        .map(|number| {
            let mut within = |reach: f32| random.random_range(-reach..reach);
            let (layer, place_in_layer) = (number / PER_LAYER, number % PER_LAYER);
            // Every layer stands over the gaps of the one below.
            let angle = TAU / PER_LAYER as f32 * (place_in_layer as f32 + 0.5 * layer as f32);
            let place = Vec3::new(REACH * angle.cos(), LOWEST_LAYER + LAYER_HEIGHT * layer as f32, REACH * angle.sin());
            let axis = Vec3::new(within(1.0), within(1.0), within(1.0)).normalize_or(Vec3::Y);
            let rotation = Quat::from_axis_angle(axis, within(3.0));
            (Pose { scale: 1.0, rotation, translation: place }, Vec3::new(within(1.5), within(1.5), within(1.5)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::{built, fastest_middle};

    #[test]
    fn toys_are_solid() {
        toys().iter().for_each(|(_, toy)| assert!(check_solid(&toy.mesh) > 0.0));
    }

    #[test]
    // The balls around them may just overlap: toys fill little of theirs.
    fn toys_start_apart() {
        let scene = built("falling");
        let poses = scene.frame(0).world_from_object;
        let balls: Vec<(Vec3, f32)> = (1..poses.len())
            .map(|i| {
                let points = scene.objects[i].mesh.positions.iter().map(|&p| poses[i].transform_point(p));
                let (low, high) = scene.objects[i].mesh.bounds().unwrap();
                let middle = poses[i].transform_point(0.5 * (low + high));
                (middle, points.map(|p| p.distance(middle)).fold(0.0, f32::max))
            })
            .collect();
        for (i, a) in balls.iter().enumerate() {
            for (j, b) in balls.iter().enumerate().skip(i + 1) {
                let room = a.0.distance(b.0) - a.1 - b.1;
                assert!(room > -0.05, "toys {} and {}: {room}", i + 1, j + 1);
            }
        }
    }

    #[test]
    fn nothing_is_faster_than_a_free_fall() {
        let drop = LOWEST_LAYER + LAYER_HEIGHT * ((FALLING.len() - 1) / PER_LAYER) as f32;
        let fastest = fastest_middle(built("falling"));
        assert!(fastest < (2.0 * 9.81 * drop).sqrt(), "{fastest} m/s");
    }
}
