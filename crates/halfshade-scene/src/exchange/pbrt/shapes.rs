//! Meshes of a scene file.

use super::parameters::Parameters;
use crate::exchange::assembly::Assembly;
use crate::{Mesh, SceneError, input, mesh};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

type Result<T> = std::result::Result<T, SceneError>;

/// Mesh files that were read already.
pub(super) type MeshFiles = BTreeMap<PathBuf, Arc<Mesh>>;

/// The mesh of a shape in its own space; `None`, and a note, where it is of a kind that isn't read.
pub(super) fn mesh_of(
    kind: &str,
    parameters: &Parameters,
    files: &mut MeshFiles,
    assembly: &mut Assembly,
) -> Result<Option<Arc<Mesh>>> {
    if parameters.kind("alpha").is_some() {
        assembly.note(&parameters.path, parameters.line, "`alpha` of a shape left out: it is whole");
    }
    match kind {
        "trianglemesh" => triangle_mesh(parameters, assembly).map(|mesh| Some(Arc::new(mesh))),
        "plymesh" => ply_mesh(parameters, files, assembly),
        "sphere" => sphere(parameters, assembly).map(|mesh| Some(Arc::new(mesh))),
        _ => {
            assembly.note(&parameters.path, parameters.line, &format!("shape `{}` left out", kind.escape_debug()));
            Ok(None)
        }
    }
}

/// The radius of a sphere.
pub(super) fn radius(parameters: &Parameters) -> Result<f64> {
    let radius = parameters.number("radius").unwrap_or(1.0);
    match radius > 0.0 {
        true => Ok(radius),
        false => Err(parameters.error_at("radius", format!("the radius of a sphere is {radius}, not positive"))),
    }
}

fn sphere(parameters: &Parameters, assembly: &mut Assembly) -> Result<Mesh> {
    if ["zmin", "zmax", "phimax"].iter().any(|name| parameters.kind(name).is_some()) {
        assembly.note(&parameters.path, parameters.line, "a part of a sphere is taken for the whole");
    }
    let radius = radius(parameters)?;
    let mut mesh = crate::builtin::shape("sphere").unwrap_or_default();
    for position in &mut mesh.positions {
        *position = (radius * position.as_dvec3()).as_vec3();
    }
    Ok(mesh)
}

fn triangle_mesh(parameters: &Parameters, assembly: &mut Assembly) -> Result<Mesh> {
    let points = vectors(parameters, "P")?.ok_or_else(|| parameters.error("a triangle mesh has no points `P`"))?;
    let normals = vectors(parameters, "N")?.unwrap_or_default();
    let pairs = |numbers: &[f64]| numbers.chunks_exact(2).map(|p| Vec2::new(p[0] as f32, p[1] as f32)).collect();
    let coordinates: Vec<Vec2> = parameters.numbers("uv").map(pairs).unwrap_or_default();
    for (name, count) in [("N", normals.len()), ("uv", coordinates.len())] {
        if count != 0 && count != points.len() {
            return Err(parameters.error_at(name, format!("{count} values of `{name}` for {} points", points.len())));
        }
    }
    let indices = match parameters.numbers("indices") {
        Some(numbers) => numbers.to_vec(),
        None if points.len() == 3 => vec![0.0, 1.0, 2.0],
        None => return Err(parameters.error("a triangle mesh has no `indices`")),
    };
    let is_index = |number: &f64| number.fract() == 0.0 && (0.0..points.len() as f64).contains(number);
    if let Some(wrong) = indices.iter().find(|number| !is_index(number)) {
        let problem = format!("index {wrong} names none of {} points", points.len());
        return Err(parameters.error_at("indices", problem));
    }
    if !indices.len().is_multiple_of(3) {
        return Err(parameters.error_at("indices", format!("{} indices aren't three for each triangle", indices.len())));
    }
    let triangles = indices.chunks_exact(3).map(|corners| [0, 1, 2].map(|corner| corners[corner] as u32)).collect();
    let is_flat = normals.is_empty();
    // Upward in pbrt.
    let texture_coordinates = coordinates.iter().map(|uv| Vec3::new(uv.x, 1.0 - uv.y, 0.0)).collect();
    let raw = Mesh { positions: points, normals, texture_coordinates, triangles, ..Mesh::default() };
    let (mesh, notes) = mesh::sound(raw).map_err(|error| parameters.error(error.problem))?;
    for note in notes {
        assembly.note(&parameters.path, parameters.line, &note);
    }
    Ok(if is_flat { faceted(&mesh) } else { mesh })
}

/// Triples of single precision.
fn vectors(parameters: &Parameters, name: &str) -> Result<Option<Vec<Vec3>>> {
    let Some(numbers) = parameters.numbers(name) else { return Ok(None) };
    if !numbers.len().is_multiple_of(3) {
        return Err(parameters.error_at(name, format!("{} numbers of `{name}` aren't three for each", numbers.len())));
    }
    Ok(Some(numbers.chunks_exact(3).map(|v| Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)).collect()))
}

fn ply_mesh(parameters: &Parameters, files: &mut MeshFiles, assembly: &mut Assembly) -> Result<Option<Arc<Mesh>>> {
    let name = parameters.text("filename").ok_or_else(|| parameters.error("a plymesh names no file"))?;
    let path = parameters.path.parent().unwrap_or(Path::new("")).join(name);
    if let Some(known) = files.get(&path) {
        return Ok(Some(known.clone()));
    }
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz")) {
        assembly.note(&parameters.path, parameters.line, "a compressed mesh file left out: unpack it");
        return Ok(None);
    }
    let bytes = input::read(&path)
        .map_err(|error| parameters.error_at("filename", format!("{}: cannot be read: {error}", path.display())))?;
    let (mut mesh, notes) = mesh::parse(&path, &bytes, None)?;
    assembly.note_all(&path, notes);
    if !has_normals(&bytes) {
        mesh = faceted(&mesh);
    }
    // Not of pbrt's surfaces.
    mesh.colors.clear();
    let mesh = Arc::new(mesh);
    files.insert(path, mesh.clone());
    Ok(Some(mesh))
}

/// Whether the header of a PLY file declares normals.
fn has_normals(bytes: &[u8]) -> bool {
    let end = bytes.windows(10).position(|window| window == b"end_header").unwrap_or(bytes.len());
    let header = String::from_utf8_lossy(&bytes[..end]);
    header.lines().any(|line| line.trim_start().starts_with("property") && line.trim_end().ends_with(" nx"))
}

/// The same triangles, each with the normal of its face at vertices of its own: what pbrt makes of a mesh without normals.
fn faceted(mesh: &Mesh) -> Mesh {
    let corners = || mesh.triangles.iter().flatten().map(|corner| *corner as usize);
    let positions: Vec<Vec3> = corners().map(|corner| mesh.positions[corner]).collect();
    let normals = positions.chunks_exact(3).flat_map(|p| {
        let [a, b, c] = [p[0], p[1], p[2]].map(Vec3::as_dvec3);
        [(b - a).cross(c - a).normalize_or(glam::DVec3::Y).as_vec3(); 3]
    });
    Mesh {
        normals: normals.collect(),
        texture_coordinates: match mesh.texture_coordinates.is_empty() {
            true => Vec::new(),
            false => corners().map(|corner| mesh.texture_coordinates[corner]).collect(),
        },
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        positions,
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_get_their_own_normals() {
        let cube = faceted(&crate::builtin::shapes::box_mesh(1));
        assert_eq!((cube.positions.len(), cube.triangles.len()), (36, 12));
        for triangle in &cube.triangles {
            let corner = cube.positions[triangle[0] as usize];
            let normal = cube.normals[triangle[1] as usize];
            assert!((normal.dot(corner) - 1.0).abs() < 1e-6);
        }
        assert!(
            has_normals(b"ply\nproperty float nx\r\nend_header\n") && !has_normals(b"ply\ncomment nx\nend_header nx")
        );
    }
}
