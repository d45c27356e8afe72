//! Shapes of unit size about the origin. Fine enough that light is seen on their vertices, which are the receivers.

use super::lathe::{ProfilePoint, lathe};
use crate::Mesh;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The names that [`shape`] knows.
pub const SHAPES: &[&str] = &["sphere", "plane", "box", "torus", "cylinder", "cone", "capsule"];

/// The shape called `name` (see [`SHAPES`]) at its usual fineness; all but the plane are closed.
///
/// A sphere of radius 1; a plane y = 0 from -1 to 1 facing +Y; a box from -1 to 1; a torus around +Y of radii 0.7 and
/// 0.3; a cylinder and a cone of radius 1 from y = -1 to 1; a capsule of radius 0.5 from y = -1 to 1.
pub fn shape(name: &str) -> Option<Mesh> {
    Some(match name {
        "sphere" => sphere(20),
        "plane" => plane(64),
        "box" => box_mesh(24),
        "torus" => torus(0.7, 0.3, 96, 40),
        "cylinder" => cylinder(96),
        "cone" => cone(96),
        "capsule" => capsule(0.5, 96),
        _ => return None,
    })
}

/// The square y = 0, x and z in [-1, 1], facing +Y, of `divisions` by `divisions` cells.
pub fn plane(divisions: usize) -> Mesh {
    let mut mesh = Mesh::default();
    push_face(&mut mesh, Vec3::ONE, [divisions, divisions, divisions], 1, None);
    mesh
}

/// The box [-1, 1]³ with `divisions` by `divisions` cells per face; vertices are doubled at edges, one per normal.
pub fn box_mesh(divisions: usize) -> Mesh {
    cuboid(Vec3::ONE, [divisions; 3])
}

/// The box from `-half_size` to `half_size`, with so many cells along x, y and z.
pub fn cuboid(half_size: Vec3, divisions: [usize; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for positive in [false, true] {
            push_face(&mut mesh, half_size, divisions, axis, Some(positive));
        }
    }
    mesh
}

/// A box to stand things on: its top has `divisions` cells along x and z, its sides one row, its bottom a fan.
///
/// Closed, like [`cuboid`], but without spending half of its vertices where nobody looks.
pub fn slab(half_size: Vec3, divisions: [usize; 2]) -> Mesh {
    let divisions = [divisions[0].max(1), 1, divisions[1].max(1)];
    let mut mesh = Mesh::default();
    push_face(&mut mesh, half_size, divisions, 1, Some(true));
    for axis in [0, 2] {
        for positive in [false, true] {
            push_face(&mut mesh, half_size, divisions, axis, Some(positive));
        }
    }
    let center = mesh.positions.len() as u32;
    let lattice = |i: usize, axis: usize| lattice_coordinate(i, divisions[axis], half_size[axis]);
    let [nx, _, nz] = divisions;
    // Around the bottom's rim, counter-clockwise seen from below.
    let rim: Vec<(usize, usize)> = ((0..nx).map(|i| (i, 0)))
        .chain((0..nz).map(|k| (nx, k)))
        .chain((0..nx).map(|i| (nx - i, nz)))
        .chain((0..nz).map(|k| (0, nz - k)))
        .collect();
    mesh.positions.push(Vec3::new(0.0, -half_size.y, 0.0));
    mesh.positions.extend(rim.iter().map(|&(i, k)| Vec3::new(lattice(i, 0), -half_size.y, lattice(k, 2))));
    mesh.normals.resize(mesh.positions.len(), Vec3::NEG_Y);
    let count = rim.len() as u32;
    mesh.triangles.extend((0..count).map(|i| [center, center + 1 + i, center + 1 + (i + 1) % count]));
    mesh
}

/// The sphere of radius 1: an icosahedron whose edges are cut into `divisions` parts, so 10·divisions² + 2 vertices.
pub fn sphere(divisions: usize) -> Mesh {
    let divisions = divisions.max(1);
    let corners = icosahedron();
    let mut mesh = Mesh::default();
    // A vertex is known by its icosahedron corners and their integer weights, so edges are shared exactly.
    let mut known: HashMap<[(usize, usize); 3], u32> = HashMap::new();
    for face in ICOSAHEDRON_FACES {
        let mut vertex = |i: usize, j: usize| {
            let mut key = [(face[0], divisions - i - j), (face[1], i), (face[2], j)];
            key.iter_mut().filter(|(_, weight)| *weight == 0).for_each(|entry| entry.0 = usize::MAX);
            key.sort_unstable();
            *known.entry(key).or_insert_with(|| {
                let sum: DVec3 =
                    key.iter().filter(|entry| entry.1 > 0).map(|&(corner, w)| corners[corner] * w as f64).sum();
                let direction = sum.normalize().as_vec3();
                mesh.positions.push(direction);
                mesh.normals.push(direction.normalize());
                mesh.positions.len() as u32 - 1
            })
        };
        let mut triangles = Vec::with_capacity(divisions * divisions);
        for i in 0..divisions {
            for j in 0..divisions - i {
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < divisions {
                    triangles.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
        mesh.triangles.append(&mut triangles);
    }
    mesh
}

/// A torus around +Y: a tube of radius `minor` whose centre line has radius `major`.
pub fn torus(major: f32, minor: f32, segments: usize, tube_segments: usize) -> Mesh {
    let profile: Vec<_> = (0..=tube_segments)
        .map(|i| {
            let (sin, cos) = (TAU * (i % tube_segments) as f64 / tube_segments as f64).sin_cos();
            ProfilePoint::smooth(major + minor * cos as f32, minor * sin as f32)
        })
        .collect();
    lathe(&profile, segments)
}

/// The cylinder of radius 1 around +Y, y in [-1, 1].
pub fn cylinder(segments: usize) -> Mesh {
    let rings = (segments / 4).max(2);
    let disc = |height: f32| (0..=rings).map(move |i| ProfilePoint::smooth(i as f32 / rings as f32, height));
    let wall = (1..rings).map(|i| ProfilePoint::smooth(1.0, 2.0 * i as f32 / rings as f32 - 1.0));
    let mut profile: Vec<_> = disc(-1.0).chain(wall).chain(disc(1.0).collect::<Vec<_>>().into_iter().rev()).collect();
    profile.iter_mut().filter(|p| p.radius == 1.0 && p.height.abs() == 1.0).for_each(|p| p.crease = true);
    lathe(&profile, segments)
}

/// The cone around +Y with its base of radius 1 at y = -1 and its tip at y = 1.
pub fn cone(segments: usize) -> Mesh {
    let rings = (segments / 4).max(2);
    let mut profile: Vec<_> = (0..rings).map(|i| ProfilePoint::smooth(i as f32 / rings as f32, -1.0)).collect();
    profile.extend((0..=rings).map(|i| {
        let x = i as f32 / rings as f32;
        ProfilePoint { radius: 1.0 - x, height: 2.0 * x - 1.0, crease: i == 0 || i == rings }
    }));
    lathe(&profile, segments)
}

/// The capsule of `radius` (at most 1) around +Y whose ends lie at y = -1 and y = 1.
pub fn capsule(radius: f32, segments: usize) -> Mesh {
    let rings = (segments / 4).max(2);
    let half_sphere = |from: f64, center: f32| {
        (0..=rings).map(move |i| {
            let (sin, cos) = (from + FRAC_PI_2 * i as f64 / rings as f64).sin_cos();
            let on_axis = i == if from < 0.0 { 0 } else { rings };
            ProfilePoint::smooth(if on_axis { 0.0 } else { radius * cos as f32 }, center + radius * sin as f32)
        })
    };
    let length = 2.0 * (1.0 - radius);
    let wall_rings = (length / radius * rings as f32 / FRAC_PI_2 as f32).ceil() as usize;
    let wall =
        (1..wall_rings).map(|i| ProfilePoint::smooth(radius, radius - 1.0 + length * i as f32 / wall_rings as f32));
    let upper = half_sphere(0.0, 1.0 - radius).skip(usize::from(length <= 0.0));
    lathe(&half_sphere(-FRAC_PI_2, radius - 1.0).chain(wall).chain(upper).collect::<Vec<_>>(), segments)
}

/// Coordinate `i` of `n + 1` equally spaced ones from `-half` to `half`; symmetric in its bits.
fn lattice_coordinate(i: usize, n: usize, half: f32) -> f32 {
    half * ((2.0 * i as f64 - n as f64) / n as f64) as f32
}

/// One face of a box, perpendicular to `axis`; `positive: None` is the middle plane, facing along the axis.
fn push_face(mesh: &mut Mesh, half_size: Vec3, divisions: [usize; 3], axis: usize, positive: Option<bool>) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (nu, nv) = (divisions[u].max(1), divisions[v].max(1));
    let sign = match positive {
        None => 0.0,
        Some(true) => 1.0,
        Some(false) => -1.0,
    };
    let facing = if sign < 0.0 { -1.0 } else { 1.0 };
    let first = mesh.positions.len() as u32;
    for j in 0..=nv {
        for i in 0..=nu {
            let mut position = Vec3::ZERO;
            position[axis] = sign * half_size[axis];
            position[u] = lattice_coordinate(i, nu, half_size[u]);
            position[v] = lattice_coordinate(j, nv, half_size[v]);
            mesh.positions.push(position);
            let mut normal = Vec3::ZERO;
            normal[axis] = facing;
            mesh.normals.push(normal);
        }
    }
    for j in 0..nv {
        for i in 0..nu {
            let a = first + (j * (nu + 1) + i) as u32;
            let (b, c) = (a + 1, a + nu as u32 + 1);
            let d = c + 1;
            // Diagonals alternate, so that the tessellation has no direction of its own.
            let pair = if (i + j) % 2 == 0 { [[a, b, d], [a, d, c]] } else { [[a, b, c], [b, d, c]] };
            mesh.triangles.extend(pair.map(|[p, q, r]| if facing > 0.0 { [p, q, r] } else { [p, r, q] }));
        }
    }
}

fn icosahedron() -> [DVec3; 12] {
    std::array::from_fn(|i| match i {
        0 => DVec3::Y,
        11 => DVec3::NEG_Y,
        _ => {
            let upper = i < 6;
            let step = if upper { i - 1 } else { i - 6 };
            let azimuth = TAU * step as f64 / 5.0 + if upper { 0.0 } else { PI / 5.0 };
            let height = if upper { 1.0 } else { -1.0 } / 5f64.sqrt();
            let ring = 2.0 / 5f64.sqrt();
            DVec3::new(ring * azimuth.cos(), height, -ring * azimuth.sin())
        }
    })
}

/// Counter-clockwise from outside: top cap, upper and lower band, bottom cap.
const ICOSAHEDRON_FACES: [[usize; 3]; 20] = {
    let mut faces = [[0; 3]; 20];
    let mut i = 0;
    while i < 5 {
        let (upper, upper_next) = (1 + i, 1 + (i + 1) % 5);
        let (lower, lower_next) = (6 + i, 6 + (i + 1) % 5);
        faces[4 * i] = [0, upper, upper_next];
        faces[4 * i + 1] = [upper, lower, upper_next];
        faces[4 * i + 2] = [upper_next, lower, lower_next];
        faces[4 * i + 3] = [11, lower_next, lower];
        i += 1;
    }
    faces
};

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Volume enclosed by the triangles, by the divergence theorem; positive if they face outward.
    pub(crate) fn signed_volume(mesh: &Mesh) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }

    /// Checks that normals are unit vectors which agree with the triangles, and that no triangle is degenerate.
    pub(crate) fn check_surface(mesh: &Mesh) {
        assert_eq!(mesh.positions.len(), mesh.normals.len());
        assert!(mesh.colors.is_empty() || mesh.colors.len() == mesh.positions.len());
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        let mut used = vec![false; mesh.positions.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.length() > 0.0, "a triangle without area at {a}");
            for i in triangle.map(|i| i as usize) {
                used[i] = true;
                let cosine = normal.normalize().dot(mesh.normals[i]);
                assert!(cosine > 0.25, "normal {} against triangle at {a}: {cosine}", mesh.normals[i]);
            }
        }
        assert!(used.iter().all(|&used| used), "a vertex without a triangle");
    }

    /// Checks that a mesh is a closed, outward facing solid once vertices of equal position are one; its volume.
    pub(crate) fn check_solid(mesh: &Mesh) -> f64 {
        check_surface(mesh);
        let mut welded: HashMap<[u32; 3], u32> = HashMap::new();
        let mut directed: HashMap<(u32, u32), usize> = HashMap::new();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| {
                // + 0.0 turns -0.0 into 0.0.
                let key = (mesh.positions[i as usize] + 0.0).to_array().map(f32::to_bits);
                let next = welded.len() as u32;
                *welded.entry(key).or_insert(next)
            });
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                *directed.entry((corners[from], corners[to])).or_default() += 1;
            }
        }
        for (&(from, to), &count) in &directed {
            assert_eq!(count, 1, "an edge is used twice in one direction");
            assert_eq!(directed.get(&(to, from)), Some(&1), "an edge has no other side");
        }
        let volume = signed_volume(mesh);
        assert!(volume > 0.0);
        volume
    }

    #[test]
    fn shapes_are_solids_of_known_volume() {
        let expected = [
            ("sphere", 4.0 / 3.0 * PI),
            ("box", 8.0),
            ("torus", 2.0 * PI * PI * 0.7 * 0.09),
            ("cylinder", 2.0 * PI),
            ("cone", 2.0 / 3.0 * PI),
            ("capsule", 0.25 * PI + PI / 6.0),
        ];
        for (name, volume) in expected {
            let measured = check_solid(&shape(name).unwrap());
            assert!((measured / volume - 1.0).abs() < 6e-3, "{name}: {measured} instead of {volume}");
        }
        assert_eq!(expected.len() + 1, SHAPES.len());
        assert!(SHAPES.iter().all(|name| shape(name).is_some()) && shape("teapot").is_none());
    }

    #[test]
    fn shapes_fill_the_unit_cube() {
        for name in SHAPES {
            let mesh = shape(name).unwrap();
            let low = mesh.positions.iter().copied().reduce(Vec3::min).unwrap();
            let high = mesh.positions.iter().copied().reduce(Vec3::max).unwrap();
            assert!((low + high).abs().max_element() < 2e-2, "{name} is not about the origin: {low} {high}");
            assert!((high.max_element() - 1.0).abs() < 1e-6, "{name}: {high}");
        }
    }

    #[test]
    fn the_plane_faces_up() {
        let mesh = plane(7);
        check_surface(&mesh);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (64, 98));
        assert!(mesh.normals.iter().all(|n| *n == Vec3::Y));
        assert!(mesh.positions.iter().all(|p| p.y == 0.0));
    }

    #[test]
    fn sphere_vertices_are_counted_and_on_the_sphere() {
        for divisions in [1, 2, 5, 20] {
            let mesh = sphere(divisions);
            assert_eq!(mesh.positions.len(), 10 * divisions * divisions + 2);
            assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        }
        check_solid(&sphere(1));
    }

    #[test]
    fn boxes_of_any_size_are_solid() {
        let half = Vec3::new(1.7, 0.3, 0.9);
        let volume = f64::from(8.0 * half.x * half.y * half.z);
        for mesh in [cuboid(half, [5, 1, 4]), slab(half, [6, 5]), slab(half, [1, 1])] {
            assert!((check_solid(&mesh) / volume - 1.0).abs() < 1e-6);
        }
        assert!((check_solid(&capsule(1.0, 64)) / (4.0 / 3.0 * PI) - 1.0).abs() < 1e-2);
    }
}
