//! Meshes at the extremes, each with spheres that bound it.

use crate::random::Random;
use glam::Vec3;
use halfshade_scene::{Mesh, Sphere, builtin::shapes};

/// A mesh of about unit size.
pub(crate) struct Shape {
    pub(crate) mesh: Mesh,
    /// Spheres that bound it; none: it is a receiver only, where sphere sets block.
    pub(crate) spheres: Vec<Sphere>,
    /// Its smallest extent: what rounding of coordinates must be small against.
    pub(crate) feature: f32,
    /// Kind of shape, for people.
    pub(crate) kind: &'static str,
}

pub(crate) fn draw(random: &mut Random) -> Shape {
    match random.below(12) {
        0..3 => ball(1 + random.below(3)),
        3 => cuboid(random),
        4 => slab(random.log_between(1e-5, 0.1)),
        5 => needle(random.log_between(1e-5, 0.1)),
        6 => triangle(),
        7 => degenerate(random),
        8 => point(),
        9 => ring(),
        10 => sheet(random.chance(0.5)),
        _ => tetrahedron(),
    }
}

const UNIT: Sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };

pub(crate) fn ball(divisions: usize) -> Shape {
    Shape { mesh: shapes::sphere(divisions), spheres: vec![UNIT], feature: 1.0, kind: "ball" }
}

/// Spheres around the cells of a grid over a box.
fn grid(half_size: Vec3, counts: [usize; 3]) -> Vec<Sphere> {
    let cell = 2.0 * half_size / Vec3::from(counts.map(|n| n as f32));
    let mut spheres = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                let place = Vec3::from([i, j, k].map(|n| n as f32 + 0.5));
                spheres.push(Sphere { center: place * cell - half_size, radius: 0.5 * cell.length() * 1.000_01 });
            }
        }
    }
    spheres
}

fn cuboid(random: &mut Random) -> Shape {
    let half_size = Vec3::new(random.between(0.1, 1.0), random.between(0.1, 1.0), random.between(0.1, 1.0));
    let mesh = shapes::cuboid(half_size, [1 + random.below(2); 3]);
    Shape { mesh, spheres: grid(half_size, [2; 3]), feature: half_size.min_element(), kind: "cuboid" }
}

fn slab(thickness: f32) -> Shape {
    let half_size = Vec3::new(1.0, 0.5 * thickness, 1.0);
    let mesh = shapes::cuboid(half_size, [2, 1, 2]);
    Shape { mesh, spheres: grid(half_size, [4, 1, 4]), feature: thickness, kind: "slab" }
}

fn needle(thickness: f32) -> Shape {
    let half_size = Vec3::new(0.5 * thickness, 1.0, 0.5 * thickness);
    let mesh = shapes::cuboid(half_size, [1, 3, 1]);
    Shape { mesh, spheres: grid(half_size, [1, 6, 1]), feature: thickness, kind: "needle" }
}

fn triangle() -> Shape {
    let positions = vec![Vec3::new(-0.8, 0.0, -0.5), Vec3::new(0.8, 0.0, -0.5), Vec3::new(0.0, 0.0, 0.9)];
    let mesh = Mesh { positions, normals: vec![Vec3::Y; 3], triangles: vec![[0, 2, 1]], ..Mesh::default() };
    Shape { mesh, spheres: vec![UNIT], feature: 1.0, kind: "triangle" }
}

/// A ball with triangles that have no area, or hardly any: a point, an edge, a sliver, one twice.
fn degenerate(random: &mut Random) -> Shape {
    let mut shape = ball(1);
    let mesh = &mut shape.mesh;
    let count = mesh.positions.len() as u32;
    let width = random.log_between(1e-7, 1e-3);
    mesh.positions.extend([mesh.positions[0] * 0.5, mesh.positions[0] * 0.5 + Vec3::splat(width)]);
    mesh.normals.extend([mesh.normals[0]; 2]);
    mesh.triangles.extend([[0, 0, 0], [0, 1, 1], [0, count, count + 1], [2, 3, count], mesh.triangles[0]]);
    shape.feature = width;
    shape.kind = "degenerate";
    shape
}

/// One vertex and no triangle.
fn point() -> Shape {
    let mesh = Mesh { positions: vec![Vec3::ZERO], normals: vec![Vec3::Y], ..Mesh::default() };
    Shape { mesh, spheres: Vec::new(), feature: 1.0, kind: "point" }
}

fn ring() -> Shape {
    let spheres = (0..12).map(|i| {
        let (sin, cos) = (i as f32 / 12.0 * std::f32::consts::TAU).sin_cos();
        Sphere { center: Vec3::new(0.7 * cos, 0.0, 0.7 * sin), radius: 0.4 }
    });
    let mesh = shapes::torus(0.7, 0.25, 9, 6);
    Shape { mesh, spheres: spheres.collect(), feature: 0.25, kind: "ring" }
}

/// An open square: seen from both sides, and of no volume.
fn sheet(blocks: bool) -> Shape {
    let mesh = shapes::plane(2);
    let spheres = if blocks { grid(Vec3::new(1.0, 0.0, 1.0), [3, 1, 3]) } else { Vec::new() };
    Shape { mesh, spheres, feature: 1.0, kind: "sheet" }
}

fn tetrahedron() -> Shape {
    let corners =
        [Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
    let mut mesh = Mesh::default();
    for face in [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] {
        let [a, b, c] = face.map(|corner: usize| corners[corner] / 3_f32.sqrt());
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([a, b, c]);
        mesh.normals.extend([(b - a).cross(c - a).normalize(); 3]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Shape { mesh, spheres: vec![UNIT], feature: 0.5, kind: "tetrahedron" }
}
