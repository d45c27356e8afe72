//! Rays through hierarchies of triangles, and holes in these.

use super::{CALLS, direction, tolerance};
use glam::{DVec3, Quat, Vec2, Vec3};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, RayBuffers, Variable},
};
use halfshade_scene::{
    Environment, Frame, Mesh, Object, Pose, Scene, Texture,
    builtin::shapes,
    mesh::AlphaMask,
    texture::{Filter, Wrap},
};
use halfshade_strategies::RayTraced;
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// Buffers that functions of `ray_traced` read of a frame.
pub(super) fn ray_buffers(frame: &Frame<'_>) -> Result<RayBuffers, Failed> {
    let params = RayTraced.info().parse("").map_err(|error| Failed::from(error.to_string()))?;
    Ok(RayBuffers::new(frame, &params)?)
}

pub(super) fn ray_variables(rays: &RayBuffers) -> [Variable<'_>; 4] {
    [
        // In storage on the device, but of a fixed size.
        Variable::uniform(0, "frame", &rays.uniforms),
        Variable::storage(1, "nodes", &rays.nodes),
        Variable::storage(2, "triangles", &rays.triangles),
        Variable::storage(3, "rows", &rays.rows),
    ]
}

const SHADER: &str = "ray_traced/traverse.wgsl";

/// A ray in the space of kernels, as the device gets it.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
    limit: f64,
}

impl Ray {
    fn new(origin: DVec3, direction: DVec3, limit: f64) -> Self {
        let single = |vector: DVec3| vector.as_vec3().as_dvec3();
        Self { origin: single(origin), direction: single(direction), limit: super::single(limit) }
    }

    /// By Möller and Trumbore.
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac) = (b - a, c - a);
        let across = self.direction.cross(ac);
        let volume = ab.dot(across);
        if volume == 0.0 {
            return false;
        }
        let offset = self.origin - a;
        let (u, around) = (offset.dot(across) / volume, offset.cross(ab));
        let (v, distance) = (self.direction.dot(around) / volume, ac.dot(around) / volume);
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance <= self.limit
    }
}

/// Whether the device finds rays blocked, starting with some slack.
fn blocked(gpu: &Arc<Gpu>, rays: &RayBuffers, list: &[Ray], slack: [f32; 2]) -> Result<Vec<bool>, Failed> {
    let inputs: Vec<[f32; 4]> = (list.iter())
        .flat_map(|ray| [ray.origin.extend(ray.limit), ray.direction.extend(0.0)])
        .map(|row| row.as_vec4().to_array())
        .collect();
    let [slack, reach] = slack;
    let body = format!(
        "let is_met = is_blocked(number % LANES, input[0].xyz, input[1].xyz, vec3f({slack:e}), {reach:e}, input[0].w);
        output[0].x = select(0.0, 1.0, is_met);"
    );
    let variables = ray_variables(rays);
    let found = Probe { shader: SHADER, bands: None, constants: &[], rows: [2, 1], body: &body, variables: &variables }
        .call(gpu, &inputs)?;
    Ok(found.iter().map(|row| row[0] == 1.0).collect())
}

/// All are as expected, but for a share that may graze an edge.
fn compare(what: &str, share: f64, found: &[bool], expected: &[bool]) -> Result<(), Failed> {
    let off: Vec<usize> = (0..expected.len()).filter(|&i| found.get(i) != Some(&expected[i])).collect();
    if off.len() as f64 > share * expected.len() as f64 {
        let (count, first) = (off.len(), off[0]);
        return Err(format!("{what}: {count} of {} are off, the first is {first}", expected.len()).into());
    }
    Ok(())
}

fn scene(objects: impl IntoIterator<Item = (Mesh, Pose)>) -> Scene {
    let objects = objects.into_iter().map(|(mesh, pose)| Object::new("object", mesh).pose(pose));
    Scene::at_rest("rays", objects.collect(), Environment::constant(Vec3::ONE))
}

/// Triangles of a frame in the space of kernels.
fn triangles(frame: &Frame<'_>, rays: &RayBuffers) -> Vec<[DVec3; 3]> {
    let of_object = |(object, pose): (&Object, &Pose)| {
        let point = |vertex: u32| {
            let point = object.mesh.positions[vertex as usize].as_dvec3() * f64::from(pose.scale);
            rays.place(pose.rotation.as_dquat() * point + pose.translation.as_dvec3())
        };
        object.mesh.triangles.iter().map(|triangle| triangle.map(point)).collect::<Vec<_>>()
    };
    frame.scene.objects.iter().zip(&frame.world_from_object).flat_map(of_object).collect()
}

fn pose(size: f32, random: &mut Pcg64Mcg) -> Pose {
    let rotation = Quat::from_axis_angle(direction(random).as_vec3().normalize(), random.random_range(0.0..6.0));
    Pose { scale: size, rotation, translation: size * direction(random).as_vec3() }
}

fn point(random: &mut Pcg64Mcg) -> Vec3 {
    Vec3::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0), random.random_range(-1.0..1.0))
}

/// Triangles without order, from slivers to halves of all; some are points or lines.
fn loose(count: usize, random: &mut Pcg64Mcg) -> Mesh {
    let corners = |i: usize| {
        let (a, size) = (point(random), [0.01, 0.1, 0.4, 1.0][i % 4]);
        let (b, c) = (a + size * point(random), a + size * point(random));
        match i % 16 {
            0 => [a, a, b],
            1 => [a, a, a],
            2 => [a, a + Vec3::X, a + 0.5 * Vec3::X],
            _ => [a, b, c],
        }
    };
    let positions: Vec<Vec3> = (0..count).flat_map(corners).collect();
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { normals: vec![Vec3::Y; positions.len()], positions, triangles, ..Mesh::default() }
}

/// Rays from anywhere, toward triangles and next to them, or along axes; of any length.
fn any_ray(number: usize, triangles: &[[DVec3; 3]], random: &mut Pcg64Mcg) -> Ray {
    let origin = 1.5 * point(random).as_dvec3();
    let axis = DVec3::AXES[number / 4 % 3] * if number % 8 < 4 { 1.0 } else { -1.0 };
    let toward = match (number % 4, triangles) {
        (0, _) | (_, []) => axis,
        (1, _) => axis.cross(direction(random)).normalize(),
        _ => {
            let [a, b, c] = triangles[number % triangles.len()];
            let (u, v) = (random.random_range(-0.2..0.8), random.random_range(-0.2..0.8));
            (a + u * (b - a) + v * (c - a) - origin).normalize()
        }
    };
    let limit = if number.is_multiple_of(3) { random.random_range(0.0..1.0) } else { 1e30 };
    Ray::new(origin, toward, limit)
}

/// Loose triangles of objects as small, as large and as different in size as may be; none at all.
pub(super) fn traverse(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(50);
    let random = &mut random;
    for sizes in [&[1.0, 1.0, 1.0][..], &[1e-9; 3], &[1e9; 3], &[1.0, 1e-4, 1e-2, 0.3, 0.1], &[1.0], &[]] {
        let objects: Vec<(Mesh, Pose)> =
            sizes.iter().map(|&size| (loose(150 + 50 * sizes.len(), random), pose(size, random))).collect();
        let scene = scene(objects);
        let frame = scene.frame(0);
        let rays = ray_buffers(&frame)?;
        let triangles = triangles(&frame, &rays);
        let list: Vec<Ray> = (0..CALLS).map(|i| any_ray(i, &triangles, random)).collect();
        let expected: Vec<bool> =
            list.iter().map(|ray| triangles.iter().any(|triangle| ray.meets(*triangle))).collect();
        let found = blocked(gpu, &rays, &list, [0.0; 2])?;
        compare(&format!("sizes {sizes:?}"), tolerance(SHADER), &found, &expected)?;
    }
    watertight(gpu, random)?;
    along_axes(gpu)?;
    degenerate(gpu, random)?;
    within_slack(gpu, random)
}

/// No ray leaves a closed mesh, aimed at vertices and edges as it may be, whatever the object's pose.
fn watertight(gpu: &Arc<Gpu>, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let mut mesh = shapes::sphere(10);
    mesh.positions.iter_mut().for_each(|position| *position *= random.random_range(0.7..1.0));
    for pose in [Pose::IDENTITY, pose(1.0, random), pose(1e-6, random), pose(1e6, random)] {
        let scene = scene([(mesh.clone(), pose)]);
        let frame = scene.frame(0);
        let rays = ray_buffers(&frame)?;
        let triangles = triangles(&frame, &rays);
        let center = rays.place(pose.translation.as_dvec3());
        let list: Vec<Ray> = (0..4 * CALLS)
            .map(|i| {
                let [a, b, c] = triangles[i / 4 % triangles.len()];
                let target = match i % 4 {
                    0 => a,
                    1 => 0.5 * (a + b),
                    2 => a.lerp(b, random.random_range(0.0..1.0)),
                    _ => (a + b + c) / 3.0,
                };
                let origin = (center + 0.05 * direction(random)).as_vec3().as_dvec3();
                Ray::new(origin, (target - origin).normalize(), 1e30)
            })
            .collect();
        let found = blocked(gpu, &rays, &list, [0.0; 2])?;
        compare(&format!("watertight, {pose:?}"), 0.0, &found, &vec![true; list.len()])?;
    }
    Ok(())
}

/// Rays exactly through vertices and along edges as seen from above, on the device as here; and rays within the plane, which
/// meet nothing.
fn along_axes(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let scene = scene([(shapes::plane(8), Pose::IDENTITY)]);
    let rays = ray_buffers(&scene.frame(0))?;
    // Lines of the grid are four steps apart.
    let places = (-15..=15).flat_map(|x| (-15..=15).map(move |z| DVec3::new(f64::from(x), 0.0, f64::from(z)) / 16.0));
    let (mut list, mut expected) = (Vec::new(), Vec::new());
    for place in places {
        for side in [DVec3::Y, DVec3::NEG_Y] {
            list.push(Ray::new(place + 0.5 * side, -side, 1e30));
            list.push(Ray::new(place + 0.5 * side, -side, 0.25));
            list.push(Ray::new(place + 0.5 * side, side, 1e30));
            list.push(Ray::new(place.with_x(-2.0 * side.y), side.y * DVec3::X, 1e30));
            expected.extend([true, false, false, false]);
        }
    }
    let found = blocked(gpu, &rays, &list, [0.0; 2])?;
    compare("along axes", 0.0, &found, &expected)
}

/// Points and lines block nothing, aimed at as they may be.
fn degenerate(gpu: &Arc<Gpu>, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    // On a lattice, where halves are without rounding.
    let mut lattice = || (8.0 * point(random)).round() / 8.0;
    let corners = (0..300).flat_map(|i| {
        let (a, b) = (lattice(), lattice());
        [[a, a, a], [a, b, a], [a, b, 0.5 * (a + b)]][i % 3]
    });
    let positions: Vec<Vec3> = corners.collect();
    let triangles = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh { normals: vec![Vec3::Y; positions.len()], positions, triangles, ..Mesh::default() };
    let scene = scene([(mesh.clone(), Pose::IDENTITY)]);
    let rays = ray_buffers(&scene.frame(0))?;
    let list: Vec<Ray> = (0..CALLS)
        .map(|i| {
            let target = rays.place(mesh.positions[i % mesh.positions.len()].as_dvec3());
            let origin = 2.0 * direction(random);
            Ray::new(origin, (target - origin).normalize(), 1e30)
        })
        .collect();
    let found = blocked(gpu, &rays, &list, [0.0; 2])?;
    compare("degenerate", 0.0, &found, &vec![false; list.len()])
}

/// A triangle that faces a ray is met behind its origin too, by as much as that may be off; one that faces away isn't within as much ahead.
fn within_slack(gpu: &Arc<Gpu>, random: &mut Pcg64Mcg) -> Result<(), Failed> {
    let scene = scene([(shapes::plane(1), Pose::IDENTITY)]);
    let rays = ray_buffers(&scene.frame(0))?;
    // Less than boxes are larger than what lies in them.
    for [slack, reach] in [[1e-6, 1e-5], [1e-6, 3e-7]] {
        let list: Vec<Ray> = (0..CALLS)
            .map(|i| {
                let down = if i % 2 == 0 { DVec3::NEG_Y } else { DVec3::Y };
                let place = 0.5 * point(random).as_dvec3();
                Ray::new(place.with_y(random.random_range(-3e-6..3e-6)), down, 1e30)
            })
            .filter(|ray| [slack, reach].iter().all(|edge| (ray.origin.y.abs() - edge).abs() > 1e-9))
            .collect();
        let expected: Vec<bool> = (list.iter())
            .map(|ray| match ray.direction.y < 0.0 {
                true => ray.origin.y > -slack.min(reach),
                false => -ray.origin.y > slack,
            })
            .collect();
        let found = blocked(gpu, &rays, &list, [slack as f32, reach as f32])?;
        compare(&format!("slack {slack}, reach {reach}"), 0.0, &found, &expected)?;
    }
    Ok(())
}

/// A square whose corners have alpha and texture coordinates far beyond their texture, and that is whole in places.
fn masked(mask: AlphaMask, reach: f32, random: &mut Pcg64Mcg) -> Mesh {
    let count = 60;
    let positions: Vec<Vec3> = (0..3 * count).map(|_| point(random)).collect();
    let coverage = |(i, _): (usize, &Vec3)| {
        let alpha = if i / 3 % 4 == 0 { 1.0 } else { random.random() };
        Vec2::new(alpha, if i / 3 % 5 == 1 { 9.0 } else { 0.0 })
    };
    Mesh {
        coverage: positions.iter().enumerate().map(coverage).collect(),
        texture_coordinates: positions.iter().map(|place| reach * place.with_z(0.0)).collect(),
        normals: vec![Vec3::Y; positions.len()],
        triangles: (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        masks: vec![mask],
        positions,
        ..Mesh::default()
    }
}

/// Masks with every kind of texture and without one, at corners, on edges and within.
pub(super) fn cutout(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(51);
    let shader = "ray_traced/cutout.wgsl";
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let mut meshes = vec![masked(AlphaMask { texture: None, cutoff: 0.5 }, 1.0, &mut random)];
    for (number, (wrap, filter)) in
        wraps.into_iter().flat_map(|wrap| [Filter::Linear, Filter::Nearest].map(|filter| (wrap, filter))).enumerate()
    {
        let alpha = (0..5 * 3).map(|_| Vec3::splat(random.random())).collect();
        let texture = Texture::new(5, 3, alpha)?.wrapped([wrap, wraps[(number + 1) % 3]]).filtered(filter);
        let mask = AlphaMask { texture: Some(Arc::new(texture)), cutoff: 0.3 };
        meshes.push(masked(mask, 3.0, &mut random));
    }
    // Far beyond its texture a mask is as its edge.
    let texture = Texture::new(2, 1, vec![Vec3::ZERO, Vec3::ONE])?.wrapped([Wrap::Clamp; 2]);
    meshes.push(masked(AlphaMask { texture: Some(Arc::new(texture)), cutoff: 0.3 }, 1e12, &mut random));
    let scene = scene(meshes.into_iter().map(|mesh| (mesh, Pose::IDENTITY)));
    let rays = ray_buffers(&scene.frame(0))?;
    let calls: Vec<(usize, usize, DVec3)> = (0..4 * CALLS)
        .map(|i| {
            let object = i % scene.objects.len();
            let (a, b) = (random.random_range(0.0..0.5), random.random_range(0.0..0.5));
            let weights = match i / 10 % 8 {
                0 => DVec3::AXES[i / 80 % 3],
                1 => DVec3::new(1.0 - a, a, 0.0),
                2 => DVec3::new(0.0, a, 1.0 - a),
                _ => DVec3::new(1.0 - a - b, a, b),
            };
            (object, random.random_range(0..scene.objects[object].mesh.triangles.len()), weights)
        })
        // Whole triangles aren't asked.
        .filter(|(object, triangle, _)| rays.holes(*object, *triangle) > 0)
        .collect();
    let inputs: Vec<[f32; 4]> = (calls.iter())
        .map(|(object, triangle, weights)| weights.extend(rays.holes(*object, *triangle).into()).as_vec4().to_array())
        .collect();
    let body = "output[0].x = select(0.0, 1.0, is_cut_out(u32(input[0].w), input[0].xyz));";
    let constants = [("HAS_CUTOUTS", 1.0)];
    let variables = ray_variables(&rays);
    let found = Probe { shader, bands: None, constants: &constants, rows: [1, 1], body, variables: &variables }
        .call(gpu, &inputs)?;
    let found: Vec<bool> = found.iter().map(|row| row[0] == 1.0).collect();
    let expected: Vec<bool> = (calls.iter())
        .map(|(object, triangle, weights)| {
            scene.objects[*object].mesh.is_cut_out(*triangle, weights.as_vec3().as_dvec3())
        })
        .collect();
    compare("holes", tolerance(shader), &found, &expected)
}
