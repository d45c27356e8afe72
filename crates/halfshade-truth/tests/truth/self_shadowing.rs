//! Rays neither meet the surface that they start on nor slip through one.

use crate::scenes::{icosphere, object, room, run, scene, square};
use glam::{Quat, Vec3};
use halfshade_scene::{Environment, Mesh, Pose, RadianceBuffer, ReceiverBuffer, Scene};
use halfshade_truth::{Options, Tracer};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const SKY: Environment = Environment::constant(Vec3::ONE);

/// Scales, and offsets as multiples of the size.
const SCALES: [f32; 3] = [1e-3, 1.0, 1e3];
const OFFSETS: [f32; 3] = [0.0, 30.0, 1e4];

pub(crate) fn placed(mesh: Mesh, scale: f32, offset: f32) -> Scene {
    let rotation = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 0.8);
    let translation = scale * offset * Vec3::new(0.7, -0.3, 0.65);
    scene(vec![object(mesh, Pose { scale, rotation, translation })], SKY, vec![])
}

/// Every vertex, and random points of every triangle with interpolated normals, as a picture would have them.
pub(crate) fn receivers(scene: &Scene, on_faces: usize) -> ReceiverBuffer {
    let frame = scene.frame(0);
    let mut receivers = ReceiverBuffer::vertices(&frame);
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let (mesh, pose) = (&scene.objects[0].mesh, &frame.world_from_object[0]);
    for _ in 0..on_faces {
        let triangle = mesh.triangles[rng.random_range(0..mesh.triangles.len())].map(|v| v as usize);
        let (a, b) = (rng.random_range(0.0_f32..1.0), rng.random_range(0.0_f32..1.0));
        let weights = [1.0 - a.sqrt(), a.sqrt() * (1.0 - b), a.sqrt() * b];
        let point = (0..3).map(|k| weights[k] * pose.transform_point(mesh.positions[triangle[k]])).sum();
        let normal: Vec3 = (0..3).map(|k| weights[k] * pose.transform_direction(mesh.normals[triangle[k]])).sum();
        receivers.push(point, normal.normalize(), Vec3::ONE, 0);
    }
    receivers
}

fn extremes(buffer: &RadianceBuffer) -> (f32, f32) {
    buffer.channels[0].iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

#[test]
fn flat_and_convex_surfaces_do_not_shadow_themselves() {
    for scale in SCALES {
        for offset in OFFSETS {
            let flat = placed(square(12), scale, offset);
            let (low, high) =
                extremes(&run(&flat, &receivers(&flat, 200), &Options { samples: 256, ..Options::default() }).radiance);
            // Far away, rounding of the vertices themselves tilts the facets by up to 1e-2.
            let tolerance = if offset > 1e3 { 2e-3 } else { 0.0 };
            assert!(low >= 1.0 - 1e-6 - tolerance && high <= 1.0 + 1e-6, "square {scale} {offset}: {low} {high}");

            let convex = placed(icosphere(3), scale, offset);
            let vertices = ReceiverBuffer::vertices(&convex.frame(0));
            let (low, high) =
                extremes(&run(&convex, &vertices, &Options { samples: 256, ..Options::default() }).radiance);
            assert!(low >= 1.0 - 1e-6 - tolerance && high <= 1.0 + 1e-6, "sphere {scale} {offset}: {low} {high}");
        }
    }
}

#[test]
fn shading_normals_lose_only_what_the_facets_hide() {
    // On a facet of a convex mesh the shading normal tilts by at most half the angle between facets; what lies between
    // its horizon and the facet's is a lune that carries (1 - cos tilt)/2 of a constant sky.
    let sphere = placed(icosphere(3), 1.0, 0.0);
    let all = receivers(&sphere, 300);
    let faces = all.view().slice(all.len() - 300..all.len());
    let tracer = Tracer::new(&sphere.frame(0));
    let estimate = halfshade_truth::estimate(
        &tracer,
        faces,
        &Options { samples: 4096, ..Options::default() },
        &halfshade_scene::progress::Silent,
    );
    let (low, high) = extremes(&estimate.radiance);
    assert!(low > 1.0 - 5e-3 && low < 1.0 - 1e-5 && high <= 1.0 + 1e-6, "{low} {high}");
}

#[test]
fn no_light_leaks_into_closed_rooms() {
    for scale in SCALES {
        for offset in OFFSETS {
            // Corners and edges of the room lie in the planes of its other walls: the hardest place to start a ray from.
            let walls = placed(room(), scale, offset);
            let mut sphere = icosphere(3);
            sphere.normals.iter_mut().for_each(|normal| *normal = -*normal);
            sphere.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            for (name, scene) in [("room", walls), ("sphere", placed(sphere, scale, offset))] {
                let estimate = run(&scene, &receivers(&scene, 300), &Options { samples: 256, ..Options::default() });
                let bright = estimate.radiance.channels[0].iter().filter(|&&v| v != 0.0).count();
                let (_, high) = extremes(&estimate.radiance);
                assert_eq!(bright, 0, "{name} {scale} {offset}: {bright} receivers, up to {high}");
            }
        }
    }
}

#[test]
fn a_receiver_in_the_plane_of_the_ground_sees_no_light_from_below() {
    // The foot of a wall: at y = 0, facing sideways, on a single sheet of ground.
    let ground = scene(vec![object(square(7), Pose { scale: 50.0, ..Pose::IDENTITY })], SKY, vec![]);
    let mut foot = ReceiverBuffer::default();
    for i in 0..40 {
        let (sin, cos) = (0.7 * i as f32).sin_cos();
        foot.push(Vec3::new(0.3 * i as f32 - 6.0, 0.0, 0.17 * i as f32), Vec3::new(cos, 0.0, sin), Vec3::ONE, 0);
    }
    let estimate = run(&ground, &foot, &Options { samples: 4096, ..Options::default() });
    for (i, &value) in estimate.radiance.channels[0].iter().enumerate() {
        assert!((value - 0.5).abs() < 5e-3, "{i}: {value}");
    }
}

#[test]
fn rays_at_vertices_and_edges_of_a_closed_mesh_never_escape() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for (scale, offset) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 30.0)] {
        let scene = placed(icosphere(4), scale, offset);
        let frame = scene.frame(0);
        let tracer = Tracer::new(&frame);
        let (mesh, pose) = (&scene.objects[0].mesh, &frame.world_from_object[0]);
        let world: Vec<Vec3> = mesh.positions.iter().map(|&p| pose.transform_point(p)).collect();
        for _ in 0..40 {
            let origin = Vec3::from_array(std::array::from_fn(|_| rng.random_range(-0.4_f32..0.4)));
            let origin = pose.transform_point(origin);
            let escaped = |target: Vec3| !tracer.occluded(origin, target - origin);
            assert_eq!(world.iter().filter(|&&vertex| escaped(vertex)).count(), 0, "vertices {scale}");
            let x = rng.random_range(0.0_f32..1.0);
            let edges = mesh.triangles.iter().map(|t| world[t[0] as usize].lerp(world[t[1] as usize], x));
            assert_eq!(edges.filter(|&point| escaped(point)).count(), 0, "edges {scale}");
        }
        // Along the axes and diagonals, with every combination of signed zeros.
        let center = pose.transform_point(Vec3::ZERO);
        for code in 0..5_usize.pow(3) {
            let direction = [code % 5, code / 5 % 5, code / 25].map(|i| [-1.0, -0.0, 0.0, 1.0, 1e-9][i]);
            let direction = Vec3::from_array(direction);
            if direction != Vec3::ZERO {
                assert!(tracer.occluded(center, direction), "{direction}");
            }
        }
    }
}
