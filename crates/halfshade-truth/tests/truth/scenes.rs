//! Small scenes with known answers, and what it takes to compare with them.

use glam::{DVec3, Vec3};
use halfshade_scene::{
    Environment, Mesh, Motion, Object, Pose, ReceiverBuffer, Scene, Sphere, SphereLight, SphereSet, progress::Silent,
};
use halfshade_truth::{Estimate, Options, Tracer};
use std::collections::HashMap;

/// A sphere of radius 1 from an icosahedron whose faces are divided `depth` times in four; vertices on the sphere.
pub(crate) fn icosphere(depth: usize) -> Mesh {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        points.extend([DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)].map(DVec3::normalize));
    }
    // The hull of an icosahedron: triples of mutual neighbours, wound outwards.
    let near = |i: usize, j: usize| points[i].dot(points[j]) > 0.4 && i != j;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = (points[j] - points[i]).cross(points[k] - points[i]).dot(points[i]) > 0.0;
                    triangles.push(if outward { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..depth {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |a: u32, b: u32, points: &mut Vec<DVec3>| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b, &mut points), middle(b, c, &mut points), middle(c, a, &mut points)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    Mesh { normals: positions.clone(), positions, triangles, ..Mesh::default() }
}

/// The square y = 0, |x|, |z| ≤ 1, facing +Y, of `n` by `n` cells.
pub(crate) fn square(n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |i: usize| -1.0 + 2.0 * i as f32 / n as f32;
    for row in 0..=n {
        for column in 0..=n {
            mesh.positions.push(Vec3::new(at(column), 0.0, at(row)));
            mesh.normals.push(Vec3::Y);
        }
    }
    let index = |row: usize, column: usize| (row * (n + 1) + column) as u32;
    for row in 0..n {
        for column in 0..n {
            let [a, b] = [index(row, column), index(row, column + 1)];
            let [c, d] = [index(row + 1, column), index(row + 1, column + 1)];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

/// A closed box |x|, |y|, |z| ≤ 1 with normals and winding towards the inside, 24 vertices.
pub(crate) fn room() -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-1.0_f32, 1.0] {
            let mut normal = Vec3::ZERO;
            normal[axis] = -side;
            let u = Vec3::AXES[(axis + 1) % 3];
            let v = normal.cross(u);
            let first = mesh.positions.len() as u32;
            for corner in [-u - v, u - v, u + v, v - u] {
                mesh.positions.push(corner - normal);
                mesh.normals.push(normal);
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh
}

pub(crate) fn object(mesh: Mesh, pose: Pose) -> Object {
    Object::new("object", mesh).pose(pose)
}

/// A finely meshed sphere with itself as its sphere set.
pub(crate) fn ball(center: Vec3, radius: f32) -> Object {
    let spheres = vec![Sphere { center: Vec3::ZERO, radius: 1.0 }];
    let pose = Pose { scale: radius, ..Pose::from_translation(center) };
    object(icosphere(6), pose).spheres(SphereSet { spheres, ..SphereSet::default() })
}

pub(crate) fn scene(objects: Vec<Object>, environment: Environment, lights: Vec<SphereLight>) -> Scene {
    Scene {
        lights: lights.into_iter().map(|light| (light, Motion::Still(Pose::IDENTITY))).collect(),
        ..Scene::at_rest("test", objects, environment)
    }
}

pub(crate) fn run(scene: &Scene, receivers: &ReceiverBuffer, options: &Options) -> Estimate {
    halfshade_truth::estimate(&Tracer::new(&scene.frame(0)), receivers.view(), options, &Silent)
}

/// Receivers on the plane y = 0, facing up.
pub(crate) fn on_the_ground(points: impl IntoIterator<Item = (f32, f32)>) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    points.into_iter().for_each(|(x, z)| receivers.push(Vec3::new(x, 0.0, z), Vec3::Y, Vec3::ONE, 0));
    receivers
}

/// `count` unit normals around `axis`, up to `spread` radians away from it.
pub(crate) fn normals_around(axis: DVec3, spread: f64, count: usize) -> Vec<DVec3> {
    let (u, v) = axis.any_orthonormal_pair();
    (0..count)
        .map(|i| {
            let angle = spread * ((i as f64 + 0.5) / count as f64).sqrt();
            let (sin, cos) = (2.399_963 * i as f64).sin_cos();
            angle.cos() * axis + angle.sin() * (cos * u + sin * v)
        })
        .collect()
}

/// Compares red values with their closed form: as many beyond 3 standard errors as Student's distribution with 15
/// degrees of freedom allows (0.9 %, tested at a chance of about 1e-4), no bias of the mean beyond 4 of its errors, and
/// an RMS standard error below `largest_error`. `model_error` is what tessellation or quadrature may miss.
pub(crate) fn assert_agrees(
    estimate: &Estimate,
    expected: impl Fn(usize) -> f64,
    largest_error: f64,
    model_error: f64,
) {
    let count = estimate.radiance.len();
    let (mut beyond, mut worst, mut sum, mut variance) = (0, 0.0_f64, 0.0, 0.0);
    for i in 0..count {
        let (value, error) = (f64::from(estimate.radiance.at(i).x), f64::from(estimate.standard_error.at(i).x));
        let difference = value - expected(i);
        assert!(value.is_finite() && error.is_finite());
        worst = worst.max(difference.abs() / (error + model_error));
        beyond += usize::from(difference.abs() > 3.0 * error + model_error);
        sum += difference;
        variance += error * error;
    }
    let rms = (variance / count as f64).sqrt();
    let mean = 0.009 * count as f64;
    assert!(rms < largest_error, "standard error {rms} is not below {largest_error}");
    assert!(
        (beyond as f64) < mean + 4.0 * mean.sqrt() + 1.0,
        "{beyond} of {count} beyond 3 standard errors, worst {worst}"
    );
    assert!(worst < 9.0, "one value lies {worst} standard errors away");
    let bias = sum.abs() / count as f64;
    assert!(
        bias < 4.0 * variance.sqrt() / count as f64 + model_error,
        "bias {bias}, error {}",
        variance.sqrt() / count as f64
    );
}
