//! Sound meshes from what files say.

use super::weld::position_key;
use super::{AlphaMask, Mesh, repaired, smooth_normals, weld};
use crate::skin::INFLUENCES;
use crate::{MorphShift, MorphTarget, SceneError, Texture};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// Coordinates beyond this would overflow f32 once multiplied three times, as volumes are.
pub(crate) const LARGEST_COORDINATE: f32 = 1e12;

/// A mesh as loaders return it: unchecked.
#[derive(Debug, Clone, Default)]
pub(super) struct RawMesh {
    /// Positions as read.
    pub(super) positions: Vec<Vec3>,
    /// Normals as read, of any length and possibly useless; empty, or one per position, zero where there is none.
    pub(super) normals: Vec<Vec3>,
    /// Colours; empty, or one per position.
    pub(super) colors: Vec<Vec3>,
    /// As in [`Mesh`], possibly not finite.
    pub(super) texture_coordinates: Vec<Vec3>,
    /// As in [`Mesh`].
    pub(super) textures: Vec<Arc<Texture>>,
    /// Triangles, with indices as read.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Joints and weights of each vertex, as in [`crate::Skin`]; empty, or one per position.
    pub(super) influences: Vec<[(u16, f32); INFLUENCES]>,
    /// As in [`Mesh`].
    pub(super) masks: Vec<AlphaMask>,
    /// As in [`Mesh`].
    pub(super) coverage: Vec<Vec2>,
    /// Morph targets whose weights move.
    pub(super) morphs: Vec<RawMorph>,
    /// Whether a vertex has the normal of its triangle, which no other has, also when the mesh deforms; empty, or one per
    /// position.
    pub(super) flat: Vec<bool>,
    /// Line number of each vertex, for messages, where the file has lines.
    pub(super) lines: Vec<usize>,
    /// Notes on what was left out or guessed, for people.
    pub(super) notes: Vec<String>,
}

/// A morph target: its weight beyond that at rest, as in [`crate::MorphTarget`], and what it shifts.
#[derive(Debug, Clone, Default)]
pub(super) struct RawMorph {
    pub(super) weight: Vec<(f64, f32)>,
    pub(super) shifts: Vec<RawShift>,
}

/// Shift of a vertex with a weight of 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawShift {
    pub(super) vertex: u32,
    pub(super) position: Vec3,
    /// Shift of the normal, while that is `from`.
    pub(super) normal: Vec3,
    pub(super) from: Vec3,
}

/// A sound mesh.
#[derive(Debug, Clone)]
pub(super) struct Assembled {
    pub(super) mesh: Mesh,
    /// As in [`RawMesh`], of the mesh's vertices.
    pub(super) influences: Vec<[(u16, f32); INFLUENCES]>,
    /// As in [`RawMesh`], of the mesh's vertices.
    pub(super) morphs: Vec<MorphTarget>,
    /// Triangles whose corners have their normals, also when the mesh deforms.
    pub(super) flat_triangles: Vec<u32>,
    /// Notes on what was left out, guessed and repaired, for people.
    pub(super) notes: Vec<String>,
}

/// Checks, repairs and completes a mesh; see [`super::load`].
pub(super) fn assemble(raw: RawMesh) -> Result<Assembled, SceneError> {
    let RawMesh { positions, normals, colors, texture_coordinates, textures, triangles, influences, .. } = raw;
    let RawMesh { masks, coverage, morphs, flat, lines, mut notes, .. } = raw;
    let about = |index: usize, problem: String| {
        let error = SceneError::new(problem).with_remedy("repair or rescale the mesh in the program that wrote it");
        match lines.get(index) {
            Some(line) => error.at_line(*line),
            None => error,
        }
    };
    if let Some((index, position)) =
        positions.iter().enumerate().find(|(_, p)| !(p.abs().max_element() <= LARGEST_COORDINATE && p.is_finite()))
    {
        let problem = if position.is_finite() {
            format!("vertex {index} lies at {position}, too far out to compute with")
        } else {
            format!("vertex {index} has a coordinate that is not a finite number: {position}")
        };
        return Err(about(index, problem));
    }
    if let Some(index) = texture_coordinates.iter().position(|coordinate| !coordinate.is_finite()) {
        return Err(about(index, format!("vertex {index} has a texture coordinate that is not a finite number")));
    }
    if let Some((index, triangle)) =
        triangles.iter().enumerate().find(|(_, t)| t.iter().any(|&v| v as usize >= positions.len()))
    {
        let count = positions.len();
        return Err(SceneError::new(format!(
            "triangle {index} names vertices {triangle:?}, but there are only {count}"
        )));
    }
    if triangles.is_empty() {
        return Err(SceneError::new("the mesh has no triangles"));
    }
    let mesh = Mesh { positions, normals, colors, texture_coordinates, textures, triangles, masks, coverage };
    let (mesh, repairs) = repaired(&mesh);
    notes.extend(repairs);
    if mesh.triangles.is_empty() {
        return Err(SceneError::new("no triangle of the mesh has an area"));
    }
    let mut stands_alone = flat.clone();
    if morphs.iter().any(|morph| !morph.shifts.is_empty()) {
        stands_alone.resize(mesh.positions.len(), false);
        morphs.iter().flat_map(|morph| &morph.shifts).for_each(|shift| stands_alone[shift.vertex as usize] = true);
    }
    let (mesh, sources) = compacted(with_unit_normals(mesh), &influences, &stands_alone);
    let morphs = morph_targets(&morphs, &mesh, &sources);
    let is_flat = |t: &u32| mesh.triangles[*t as usize].iter().all(|&v| flat.get(sources[v as usize]) == Some(&true));
    let flat_triangles = (0..mesh.triangles.len() as u32).filter(is_flat).collect();
    let influences = sources.iter().filter_map(|&vertex| influences.get(vertex).copied()).collect();
    Ok(Assembled { mesh, influences, morphs, flat_triangles, notes })
}

/// Morph targets of a mesh whose vertices have these numbers in the file.
fn morph_targets(morphs: &[RawMorph], mesh: &Mesh, sources: &[usize]) -> Vec<MorphTarget> {
    let number_of: HashMap<usize, u32> = if morphs.is_empty() {
        HashMap::new()
    } else {
        sources.iter().enumerate().map(|(vertex, &source)| (source, vertex as u32)).collect()
    };
    let shift = |shift: &RawShift| {
        let vertex = *number_of.get(&(shift.vertex as usize))?;
        // Repair may have turned the normal around.
        let is_turned = mesh.normals[vertex as usize].dot(shift.from) < 0.0;
        let normal = if is_turned { -shift.normal } else { shift.normal };
        Some(MorphShift { vertex, position: shift.position, normal })
    };
    let target = |morph: &RawMorph| MorphTarget {
        weight: morph.weight.clone(),
        shifts: morph.shifts.iter().filter_map(shift).collect(),
    };
    morphs.iter().map(target).collect()
}

/// Normals of unit length: those given, else smooth ones.
fn with_unit_normals(mut mesh: Mesh) -> Mesh {
    mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
    // Through f64: a tiny normal still has a direction, and a huge one no infinite length.
    let unit = |n: &Vec3| n.as_dvec3().try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3());
    mesh.normals = mesh.normals.iter().map(unit).collect();
    if mesh.normals.contains(&Vec3::ZERO) {
        let welded = weld(&mesh);
        let smooth = smooth_normals(&welded);
        for (normal, &vertex) in mesh.normals.iter_mut().zip(&welded.vertex_of) {
            if *normal == Vec3::ZERO {
                *normal = smooth[vertex as usize];
            }
        }
    }
    mesh
}

/// The same mesh without unused vertices, and with one vertex where several were equal in everything, what moves them
/// included; of each vertex that is left its number before. Those that stand alone stay so.
fn compacted(mesh: Mesh, influences: &[[(u16, f32); INFLUENCES]], stands_alone: &[bool]) -> (Mesh, Vec<usize>) {
    let mut result = Mesh { textures: mesh.textures, masks: mesh.masks, ..Mesh::default() };
    let mut sources = Vec::new();
    let mut index_of: HashMap<_, u32> = HashMap::with_capacity(mesh.positions.len());
    for triangle in &mesh.triangles {
        result.triangles.push(triangle.map(|v| {
            let v = v as usize;
            let (position, normal) = (mesh.positions[v], mesh.normals[v]);
            let (color, place) = (mesh.colors.get(v).copied(), mesh.texture_coordinates.get(v).copied());
            let coverage = mesh.coverage.get(v).copied();
            let key = [position, normal, color.unwrap_or_default(), place.unwrap_or_default()].map(position_key);
            let moved_by = influences.get(v).map(|list| list.map(|(joint, weight)| (joint, weight.to_bits())));
            let alone = stands_alone.get(v).is_some_and(|alone| *alone).then_some(v);
            let apart = (moved_by, alone, coverage.map(|coverage| coverage.to_array().map(f32::to_bits)));
            *index_of.entry((key, apart)).or_insert_with(|| {
                result.positions.push(position);
                result.normals.push(normal);
                result.colors.extend(color);
                result.texture_coordinates.extend(place);
                result.coverage.extend(coverage);
                sources.push(v);
                result.positions.len() as u32 - 1
            })
        }));
    }
    if result.colors.iter().all(|color| *color == Vec3::ONE) {
        result.colors.clear();
    }
    (result, sources)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;

    fn raw(mesh: Mesh) -> RawMesh {
        let Mesh { positions, normals, colors, texture_coordinates, textures, triangles, .. } = mesh;
        RawMesh { positions, normals, colors, texture_coordinates, textures, triangles, ..RawMesh::default() }
    }

    #[test]
    fn normals_are_made_unit_and_filled_in_across_seams() {
        let mut mesh = shapes::shape("sphere").unwrap();
        let sound = mesh.clone();
        mesh.normals.iter_mut().for_each(|n| *n *= 1e-30);
        mesh.normals[7] = Vec3::splat(f32::NAN);
        mesh.normals[9] = Vec3::ZERO;
        let mesh = assemble(raw(mesh)).unwrap().mesh;
        assert_eq!(mesh.positions.len(), sound.positions.len());
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        assert!(mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| n.distance(p.normalize()) < 0.02));
        // A box whose faces are split, without normals: each corner has one, so equal vertices merge.
        let mut split = shapes::box_mesh(2);
        split.normals.clear();
        let mesh = assemble(raw(split)).unwrap().mesh;
        assert_eq!(mesh.positions.len(), 26);
    }

    #[test]
    fn unused_vertices_go_and_white_is_no_colour() {
        let mut mesh = shapes::plane(1);
        mesh.positions.push(Vec3::ONE);
        mesh.normals.push(Vec3::ONE);
        mesh.colors = vec![Vec3::ONE; mesh.positions.len()];
        let Assembled { mesh, notes, .. } = assemble(raw(mesh)).unwrap();
        assert_eq!((mesh.positions.len(), mesh.colors.len(), notes.len()), (4, 0, 0));
    }

    #[test]
    fn vertices_stay_split_where_texture_coordinates_jump_and_repair_keeps_them() {
        let plane = shapes::plane(2);
        let place = |p: &Vec3| Vec3::new(0.5 + 0.5 * p.x, 0.5 + 0.5 * p.z, 0.0);
        // Each triangle has its own three vertices; those right of the middle have another island's coordinates.
        let mut split = Mesh::default();
        for (t, triangle) in plane.triangles.iter().enumerate() {
            let corners = triangle.map(|v| plane.positions[v as usize]);
            let island = if corners.iter().map(|p| p.x).sum::<f32>() > 0.0 { 5.0 * Vec3::X } else { Vec3::ZERO };
            split.positions.extend(corners);
            split.texture_coordinates.extend(corners.map(|p| place(&p) + island));
            let first = 3 * t as u32;
            split.triangles.push([first, first + 1, first + 2]);
        }
        // Damage that repair undoes.
        split.triangles[3].swap(0, 1);
        let Assembled { mesh, notes, .. } = assemble(raw(split)).unwrap();
        // Nine places, three of them on the seam.
        assert_eq!((mesh.positions.len(), mesh.texture_coordinates.len(), notes.len()), (12, 12, 1));
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| v as usize);
            let island = corners.map(|v| (mesh.texture_coordinates[v] - place(&mesh.positions[v])).x.round());
            let right = corners.iter().map(|&v| mesh.positions[v].x).sum::<f32>() > 0.0;
            assert_eq!(island, [if right { 5.0 } else { 0.0 }; 3]);
        }
    }

    #[test]
    fn vertices_that_other_joints_move_stay_apart_and_keep_theirs() {
        // Two triangles that share an edge, each with vertices of its own.
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)].to_vec();
        let normals = vec![Vec3::NEG_Y; 6];
        let mesh = Mesh { positions, normals, triangles: vec![[3, 4, 5], [0, 1, 2]], ..Mesh::default() };
        let of_joint = |joint: u16| [(joint, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let assembled = |joints: [u16; 6]| {
            assemble(RawMesh { influences: joints.map(of_joint).to_vec(), ..raw(mesh.clone()) }).unwrap()
        };
        let apart = assembled([0, 0, 0, 1, 1, 1]);
        assert_eq!(apart.influences, [1, 1, 1, 0, 0, 0].map(of_joint));
        assert_eq!(apart.mesh.positions.len(), 6);
        let together = assembled([0, 1, 2, 2, 1, 3]);
        assert_eq!(together.influences, [2, 1, 3, 0].map(of_joint));
        assert_eq!(together.mesh.positions, [Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO]);
    }

    #[test]
    fn what_cannot_be_a_mesh_is_refused() {
        let failure = |change: fn(&mut RawMesh)| {
            let mut raw = raw(shapes::plane(1));
            raw.lines = vec![10, 11, 12, 13];
            change(&mut raw);
            assemble(raw).unwrap_err()
        };
        let error = |change| failure(change).problem;
        assert_eq!(failure(|raw| raw.positions[2].y = f32::NAN).line, Some(12));
        assert!(error(|raw| raw.positions[1].x = f32::INFINITY).contains("vertex 1"));
        assert!(error(|raw| raw.positions[1].x = 1e30).contains("too far"));
        let error_of_place = failure(|raw| {
            raw.texture_coordinates = vec![Vec3::ZERO; 4];
            raw.texture_coordinates[3].y = f32::NAN;
        });
        assert!(error_of_place.line == Some(13) && error_of_place.problem.contains("vertex 3 has a texture"));
        assert!(error(|raw| raw.triangles[1][0] = 4).contains("triangle 1"));
        assert!(error(|raw| raw.triangles.clear()).contains("no triangles"));
        assert!(error(|raw| raw.positions.iter_mut().for_each(|p| p.x = 0.0)).contains("area"));
    }
}
