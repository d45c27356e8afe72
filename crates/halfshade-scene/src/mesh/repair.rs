//! Repair: triangles without area go, duplicates go, windings agree, closed bodies face outward.

use super::orient::orient;
use super::topology::signed_volume;
use super::winding::winding;
use super::{Mesh, Welded, doubled_area_vector, weld};
use glam::{DVec3, Vec3};
use std::collections::HashSet;

/// The mesh, repaired, and what was done, for people; nothing said if nothing was done.
///
/// - Triangles without area, and all but the first of triangles with the same three corners, are removed.
/// - Within each body (see [`super::Body`]) the smaller part by area is turned around where windings disagree. One-sided
///   bodies stay as they are.
/// - Closed bodies of negative volume are turned around, unless they lie inside an odd number of other bodies: a cavity
///   is rightly turned inward. Open bodies keep the side that most of their area shows.
/// - Normals that then face away from every triangle around them are turned around too.
///
/// Holes and edges shared by more than two triangles stay: closing them would invent geometry. Vertices stay, used or
/// not, so that indices keep their meaning.
pub fn repaired(mesh: &Mesh) -> (Mesh, Vec<String>) {
    let mut notes = Vec::new();
    let mut note = |count: usize, what: &str| {
        if count > 0 {
            notes.push(format!("{what}: {count}"));
        }
    };
    let mut result = mesh.clone();

    let has_area = |t: &[u32; 3]| doubled_area_vector(t.map(|v| mesh.positions[v as usize])) != DVec3::ZERO;
    result.triangles.retain(has_area);
    note(mesh.triangles.len() - result.triangles.len(), "triangles without area removed");

    let before = result.triangles.len();
    let welded = weld(&result);
    let mut seen = HashSet::with_capacity(before);
    let mut corners = welded.triangles.iter();
    // Triangles with an area never collapse by welding, so both lists run in step.
    result.triangles.retain(|_| {
        corners.next().is_none_or(|triangle| {
            let mut key = *triangle;
            key.sort_unstable();
            seen.insert(key)
        })
    });
    note(before - result.triangles.len(), "duplicate triangles removed");

    let mut welded = weld(&result);
    let orientation = orient(&welded);
    for (triangle, flip) in welded.triangles.iter_mut().zip(&orientation.flip) {
        if *flip {
            triangle.swap(1, 2);
        }
    }
    let inside_out = inside_out_bodies(
        &welded,
        &orientation.body_of,
        &orientation.bodies.iter().map(|b| b.closed && b.orientable).collect::<Vec<_>>(),
    );
    let mut turned = 0;
    for (t, triangle) in result.triangles.iter_mut().enumerate() {
        let flip = orientation.flip[t] != inside_out[orientation.body_of[t] as usize];
        if flip {
            triangle.swap(1, 2);
            turned += 1;
        }
    }
    note(turned, "triangles turned around, so that neighbours agree and closed bodies face outward");
    note(orientation.bodies.iter().filter(|body| !body.orientable).count(), "one-sided bodies left as they are");
    if turned > 0 {
        turn_normals(&mut result);
    }
    (result, notes)
}

/// Closed bodies that must be turned around.
fn inside_out_bodies(welded: &Welded, body_of: &[u32], solid: &[bool]) -> Vec<bool> {
    let mut members = vec![Vec::new(); solid.len()];
    for (t, &body) in body_of.iter().enumerate() {
        members[body as usize].push(t);
    }
    let apex = welded.positions.first().map_or(DVec3::ZERO, |p| p.as_dvec3());
    let volume = |body: usize| -> f64 { members[body].iter().map(|&t| signed_volume(welded.corners(t), apex)).sum() };
    (0..solid.len())
        .map(|body| {
            if !solid[body] || volume(body) >= 0.0 {
                return false;
            }
            let [a, b, c] = welded.corners(members[body][0]).map(Vec3::as_dvec3);
            let point = (a + b + c) / 3.0;
            let is_around =
                |other: usize| winding(members[other].iter().map(|&t| welded.corners(t)), point).abs() > 0.5;
            let around = (0..solid.len()).filter(|&other| other != body && solid[other] && is_around(other));
            around.count() % 2 == 0
        })
        .collect()
}

/// Turns normals that face away from the triangles around them.
fn turn_normals(mesh: &mut Mesh) {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let area_vector = doubled_area_vector(triangle.map(|v| mesh.positions[v as usize]));
        triangle.iter().for_each(|&v| sums[v as usize] += area_vector);
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(sums) {
        if normal.as_dvec3().dot(sum) < 0.0 {
            *normal = -*normal;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;
    use crate::mesh::Topology;

    fn scaled(mesh: &Mesh, scale: f32, offset: Vec3) -> Mesh {
        Mesh { positions: mesh.positions.iter().map(|p| scale * p + offset).collect(), ..mesh.clone() }
    }

    fn turned(mesh: &Mesh) -> Mesh {
        let triangles = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        Mesh { triangles, normals: mesh.normals.iter().map(|n| -n).collect(), ..mesh.clone() }
    }

    fn together(a: &Mesh, b: &Mesh) -> Mesh {
        let offset = a.positions.len() as u32;
        Mesh {
            positions: [&a.positions[..], &b.positions].concat(),
            normals: [&a.normals[..], &b.normals].concat(),
            triangles: a.triangles.iter().copied().chain(b.triangles.iter().map(|t| t.map(|v| v + offset))).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn sound_meshes_pass_untouched() {
        for name in shapes::SHAPES {
            let mesh = shapes::shape(name).unwrap();
            assert_eq!(repaired(&mesh), (mesh, Vec::new()), "{name}");
        }
    }

    #[test]
    fn damage_is_undone() {
        let sound = shapes::box_mesh(3);
        let mut damaged = turned(&sound);
        for t in [0, 7, 20] {
            damaged.triangles[t].swap(0, 2);
        }
        damaged.triangles.push(damaged.triangles[4]);
        damaged.triangles.push([0, 0, 1]);
        let (mesh, notes) = repaired(&damaged);
        assert_eq!(notes.len(), 3, "{notes:?}");
        let topology = Topology::of(&mesh);
        assert!(topology.is_solid(), "{topology:?}");
        assert!((topology.volume - 8.0).abs() < 1e-6);
        assert_eq!(mesh.normals, sound.normals);
    }

    #[test]
    fn bodies_face_outward_and_cavities_inward() {
        let sphere = shapes::shape("sphere").unwrap();
        let volume = Topology::of(&sphere).volume;
        let cavity = turned(&scaled(&sphere, 0.5, Vec3::ZERO));
        let hollow = together(&sphere, &cavity);
        assert_eq!(repaired(&hollow), (hollow.clone(), Vec::new()));
        let apart = together(&sphere, &turned(&scaled(&sphere, 0.5, 5.0 * Vec3::X)));
        let topology = Topology::of(&repaired(&apart).0);
        assert_eq!(topology.bodies.len(), 2);
        assert!((topology.volume - 1.125 * volume).abs() < 1e-4 * volume);
        // The hollow ball, turned as a whole.
        let topology = Topology::of(&repaired(&turned(&hollow)).0);
        assert!(topology.volume > 0.0 && topology.is_solid());
    }

    #[test]
    fn an_open_sheet_keeps_its_side() {
        let mut mesh = shapes::plane(4);
        mesh.triangles[3].swap(0, 1);
        let (mesh, notes) = repaired(&mesh);
        assert_eq!(notes.len(), 1);
        assert_eq!(mesh.triangles.len(), 32);
        assert!(mesh.triangles.iter().all(|t| doubled_area_vector(t.map(|v| mesh.positions[v as usize])).y > 0.0));
    }
}
