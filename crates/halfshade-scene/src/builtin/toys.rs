//! Objects that fall in heaps: their meshes, about the origin or standing on y = 0, and the convex pieces they collide
//! as.

use super::implicit::{Body, smooth_path};
use super::physics::Piece;
use super::polygonize::polygonize;
use super::{ducks, shapes, squirrel_and_balls};
use crate::Mesh;
use glam::{DQuat, Vec3};
use std::f64::consts::TAU;

/// A falling toy: a mesh and its pieces.
pub(super) struct Toy {
    pub(super) mesh: Mesh,
    pub(super) pieces: Vec<Piece>,
}

impl Toy {
    /// A toy that is nearly convex.
    fn convex(mesh: Mesh) -> Self {
        Self::in_parts(mesh, |_| 0)
    }

    fn in_parts(mesh: Mesh, part_at: impl Fn(Vec3) -> usize) -> Self {
        Self { pieces: Piece::hulls(&mesh, part_at), mesh }
    }

    /// A turned body, cut where its outline bends inward.
    pub(super) fn turned(mesh: Mesh, cuts: &[f32]) -> Self {
        Self::in_parts(mesh, |p| cuts.iter().filter(|&&height| p.y > height).count())
    }
}

/// A teapot of china with a gilded knob.
pub(super) fn teapot() -> Toy {
    let (china, gold) = (Vec3::new(0.80, 0.84, 0.86), Vec3::new(0.78, 0.55, 0.16));
    let blue = Vec3::new(0.10, 0.22, 0.58);
    let still = DQuat::IDENTITY;
    let spout = smooth_path(&[
        [0.32, 0.20, 0.0, 0.11],
        [0.50, 0.27, 0.0, 0.085],
        [0.60, 0.42, 0.0, 0.062],
        [0.72, 0.54, 0.0, 0.050],
    ]);
    let handle = smooth_path(&[
        [-0.34, 0.46, 0.0, 0.048],
        [-0.52, 0.50, 0.0, 0.045],
        [-0.64, 0.38, 0.0, 0.045],
        [-0.60, 0.22, 0.0, 0.045],
        [-0.38, 0.14, 0.0, 0.048],
    ]);
    let body = Body::new(0.02)
        .ellipsoid([0.0, 0.30, 0.0], [0.44, 0.32, 0.44], still, 0.0, china)
        .tube(&spout, 0.06, china)
        .tube(&handle, 0.03, blue)
        .ellipsoid([0.0, 0.575, 0.0], [0.24, 0.085, 0.24], still, 0.02, blue)
        .sphere([0.0, 0.69, 0.0], 0.062, 0.03, gold)
        .flat_base(0.0, 0.03);
    Toy::in_parts(polygonize(&body, 0.028), |p| match p {
        _ if p.x > 0.40 => 1 + usize::from(p.x > 0.58),
        _ if p.x < -0.42 => 3 + usize::from(p.y > 0.28) + 2 * usize::from(p.x < -0.54),
        _ if p.y > 0.62 => 7,
        _ => 0,
    })
}

/// A ring like those of a child's pyramid.
pub(super) fn ring() -> Toy {
    Toy::in_parts(shapes::torus(0.36, 0.14, 96, 40), |p| sector(p.z.atan2(p.x), 14))
}

/// A trefoil knot.
pub(super) fn knot() -> Toy {
    const STEPS: usize = 96;
    const RADIUS: f64 = 0.088;
    let at = |t: f64| {
        let (x, y) = (t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos());
        [0.155 * x, 0.20 * -(3.0 * t).sin(), 0.155 * y, RADIUS]
    };
    // The last point is the first again, bit by bit.
    let path: Vec<[f64; 4]> = (0..=STEPS).map(|i| at(TAU * (i % STEPS) as f64 / STEPS as f64)).collect();
    let body = Body::new(0.02).tube(&path, 0.0, Vec3::ONE);
    let nearest_step = |p: Vec3| {
        let distance =
            |i: &usize| Vec3::from_array([path[*i][0], path[*i][1], path[*i][2]].map(|x| x as f32)).distance(p);
        (0..STEPS).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    Toy::in_parts(polygonize(&body, 0.025), |p| nearest_step(p) / 4)
}

/// A plump star with five arms.
pub(super) fn star() -> Toy {
    const ARMS: usize = 5;
    let color = Vec3::ONE;
    let mut body = Body::new(0.02).ellipsoid([0.0; 3], [0.22, 0.13, 0.22], DQuat::IDENTITY, 0.0, color);
    for arm in 0..ARMS {
        let (sin, cos) = (TAU * arm as f64 / ARMS as f64).sin_cos();
        body = body.tube(&[[0.1 * cos, 0.0, 0.1 * sin, 0.125], [0.43 * cos, 0.0, 0.43 * sin, 0.05]], 0.06, color);
    }
    Toy::in_parts(polygonize(&body, 0.021), |p| if p.length() < 0.2 { ARMS } else { sector(p.z.atan2(p.x), ARMS) })
}

/// A jack: three crossed bars with a ball at either end.
pub(super) fn jack() -> Toy {
    let (steel, red) = (Vec3::new(0.55, 0.57, 0.60), Vec3::new(0.75, 0.10, 0.08));
    let mut body = Body::new(0.02).sphere([0.0; 3], 0.11, 0.0, steel);
    for axis in 0..3 {
        let end = |x: f64, radius: f64| {
            let mut point = [0.0, 0.0, 0.0, radius];
            point[axis] = x;
            point
        };
        body = body.tube(&[end(-0.36, 0.062), end(0.36, 0.062)], 0.05, steel);
        for x in [-0.36, 0.36] {
            let [x, y, z, radius] = end(x, 0.115);
            body = body.sphere([x, y, z], radius, 0.04, red);
        }
    }
    // A bar and a ball on each of the six sides, and the middle.
    Toy::in_parts(polygonize(&body, 0.023), |p| {
        let axis = p.abs().max_position();
        let side = 2 * axis + usize::from(p[axis] > 0.0);
        let out = p[axis].abs();
        if out < 0.10 { 0 } else { 1 + side + if out > 0.27 { 6 } else { 0 } }
    })
}

/// A wooden block whose faces have a painted square within a frame.
pub(super) fn block() -> Toy {
    const HALF: f32 = 0.27;
    let mut mesh = shapes::cuboid(Vec3::splat(HALF), [22; 3]);
    let (wood, blue, red, green) = (
        Vec3::new(0.76, 0.58, 0.36),
        Vec3::new(0.10, 0.28, 0.62),
        Vec3::new(0.72, 0.12, 0.08),
        Vec3::new(0.12, 0.46, 0.18),
    );
    mesh.colors = mesh
        .positions
        .iter()
        .zip(&mesh.normals)
        .map(|(p, normal)| {
            let face = normal.abs().max_position();
            let across = (0..3).filter(|&axis| axis != face).map(|axis| p[axis].abs()).fold(0.0, f32::max);
            let painted = (0.3 * HALF..=0.8 * HALF).contains(&across);
            if painted { [blue, red, green][face] } else { wood }
        })
        .collect();
    Toy::convex(mesh)
}

/// The rubber duck of its own scene, coarser.
pub(super) fn duck() -> Toy {
    Toy::in_parts(polygonize(&ducks::duck(), 0.0305), |p| match p {
        _ if p.y > 0.70 && p.x > 0.50 => 1,
        _ if p.y > 0.70 && p.x > -0.1 => 2,
        _ if p.x < -0.42 && p.y > 0.45 => 3,
        _ => 0,
    })
}

/// The squirrel of its own scene.
pub(super) fn squirrel() -> Toy {
    Toy::in_parts(squirrel_and_balls::squirrel_mesh(), |p| match p {
        _ if p.x < -0.30 => 4 + (p.y / 0.28) as usize,
        _ if p.y > 1.06 => 1 + usize::from(p.z > 0.0),
        _ if p.y > 0.74 => 3,
        _ => 0,
    })
}

/// A drum of two colours.
pub(super) fn drum() -> Toy {
    let mut mesh = shapes::cylinder(72);
    let (skin, red) = (Vec3::new(0.84, 0.78, 0.66), Vec3::new(0.62, 0.10, 0.12));
    mesh.positions.iter_mut().for_each(|p| *p *= Vec3::new(0.32, 0.20, 0.32));
    // Walls and discs keep their normals: they are parallel or perpendicular to the axis of the stretch.
    mesh.colors = mesh.normals.iter().map(|n| if n.y.abs() > 0.5 { skin } else { red }).collect();
    Toy::convex(mesh)
}

/// Which of `count` sectors of a full turn an angle lies in the middle of.
fn sector(angle: f32, count: usize) -> usize {
    ((angle / std::f32::consts::TAU * count as f32).round() as isize).rem_euclid(count as isize) as usize
}
