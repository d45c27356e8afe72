//! Mesh files: which loader reads what.

use super::{Mesh, assemble, gltf, obj, ply};
use crate::SceneError;
use std::path::Path;

/// Extensions of the mesh files that [`load`] reads, in lower case.
pub const EXTENSIONS: &[&str] = &["obj", "ply", "gltf", "glb"];

/// Reads a mesh file: OBJ, PLY (ASCII, binary of both byte orders), glTF or GLB, by extension.
///
/// All objects of the file become one mesh. Polygons are cut into fans of triangles, which suits convex ones. The mesh
/// is repaired as [`super::repaired`] says, unused vertices go, and vertices equal in everything become one. Normals are
/// the file's, made unit length; where a file has none or has useless ones, [`super::smooth_normals`] fill in. Of
/// materials a glTF's base colour is read, factor and texture; an OBJ's material library is not.
///
/// Nothing is returned of a file that is damaged anywhere: no part of a mesh passes for the whole.
pub fn load(path: &Path) -> Result<Mesh, SceneError> {
    load_with_notes(path).map(|(mesh, _)| mesh)
}

/// Like [`load`], with what was repaired, for people.
pub fn load_with_notes(path: &Path) -> Result<(Mesh, Vec<String>), SceneError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let read: fn(&Path, &[u8]) -> Result<assemble::RawMesh, SceneError> = match extension.as_str() {
        "obj" => |_, bytes| obj::parse(bytes),
        "ply" => |_, bytes| ply::parse(bytes),
        "gltf" | "glb" => gltf::parse,
        _ => {
            return Err(SceneError::new(format!("`.{extension}` is no mesh format known here"))
                .with_remedy(format!("use one of: .{}", EXTENSIONS.join(", .")))
                .in_file(path));
        }
    };
    let bytes =
        std::fs::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(path))?;
    if bytes.is_empty() {
        return Err(SceneError::new("the file is empty").in_file(path));
    }
    read(path, &bytes).and_then(assemble::assemble).map_err(|error| error.in_file(path))
}
