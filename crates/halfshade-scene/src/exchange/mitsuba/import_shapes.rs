//! Meshes of a scene file.

use super::element::{Elements, line};
use crate::builtin::shape;
use crate::exchange::assembly::Assembly;
use crate::{Mesh, SceneError, mesh};
use glam::Vec3;
use roxmltree::Node;
use std::sync::Arc;

/// The mesh of a shape in its own space; `None`, and a note, where it is of a kind that isn't read.
pub(super) fn mesh_of<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
) -> Result<Option<Arc<Mesh>>, SceneError> {
    let kind = elements.kind(node);
    let mut mesh = match &*kind {
        "ply" | "obj" => from_file(elements, node, &kind, assembly)?,
        "cube" => built_in("box"),
        "rectangle" => rectangle(),
        "sphere" => sphere(elements, node)?,
        _ => {
            assembly.note(elements.path, line(node), &format!("shape `{kind}` left out"));
            return Ok(None);
        }
    };
    if elements.flag(node, "face_normals") == Some(true) {
        assembly.note(elements.path, line(node), "`face_normals` left out: normals are the mesh's");
    }
    if elements.flag(node, "flip_normals") == Some(true) {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh.normals.iter_mut().for_each(|normal| *normal = -*normal);
    }
    Ok(Some(Arc::new(mesh)))
}

fn from_file<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    kind: &str,
    assembly: &mut Assembly,
) -> Result<Mesh, SceneError> {
    let name = elements.text(node, "filename").ok_or_else(|| elements.error(node, "a shape names no file"))?;
    let path = elements.path.parent().map_or_else(|| (&name).into(), |folder| folder.join(&name));
    let (mut mesh, notes) = mesh::load_with_notes(&path).map_err(|error| match path.is_file() {
        true => error,
        false => elements.error(node, error.to_string()),
    })?;
    assembly.note_all(&path, notes);
    // Coordinates of OBJ files rise unless told otherwise, those of PLY files fall.
    let rises = elements.flag(node, "flip_tex_coords").unwrap_or(kind == "obj");
    if !rises {
        mesh.texture_coordinates.iter_mut().for_each(|place| place.y = 1.0 - place.y);
    }
    Ok(mesh)
}

fn built_in(name: &str) -> Mesh {
    shape(name).unwrap_or_default()
}

/// The square from -1 to 1 that faces +Z.
fn rectangle() -> Mesh {
    let mut mesh = built_in("plane");
    let turned = |v: &mut Vec3| *v = Vec3::new(v.x, -v.z, v.y);
    mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(turned);
    mesh
}

fn sphere<'a, 'input>(elements: &Elements<'a, 'input>, node: Node<'a, 'input>) -> Result<Mesh, SceneError> {
    let center = elements.property(node, "center").map(|node| elements.vector(node, 0.0)).transpose()?;
    let radius = elements.number(node, "radius")?.unwrap_or(1.0);
    if radius <= 0.0 {
        return Err(elements.error(node, format!("the radius of a sphere is {radius}, not positive")));
    }
    let center = center.unwrap_or_default();
    let mut mesh = built_in("sphere");
    for position in &mut mesh.positions {
        *position = (radius * position.as_dvec3() + center).as_vec3();
    }
    Ok(mesh)
}
