//! Mesh files: which loader reads what.

use super::assemble::{Assembled, LARGEST_COORDINATE, RawMesh, assemble};
use super::file_scene::{FileScene, MovingPart};
use super::{Animation, ColorEncoding, Mesh, gltf, obj, ply};
use crate::{SceneError, Skin};
use std::path::Path;

/// Extensions of the mesh files that [`load`] reads, in lower case.
pub const EXTENSIONS: &[&str] = &["obj", "ply", "gltf", "glb"];

/// Reads a mesh file: OBJ, PLY (ASCII, binary of both byte orders), glTF or GLB, by extension.
///
/// All objects of the file become one mesh. Polygons are cut into triangles that keep their area. The mesh is repaired
/// as [`super::repaired`] says, unused vertices go, and vertices equal in everything become one. Normals are the
/// file's, made unit length; where a file has none or has useless ones, [`super::smooth_normals`] fill in, except that
/// a glTF's primitives without normals are flat. The base colour of a glTF's materials is read, factor and texture, and
/// alpha masks are cut out; an OBJ's material library is not read. A glTF's meshes stand where nodes or, if they have
/// skins, joints put them, with the morph targets' weights that the document gives.
///
/// Nothing is returned of a file that is damaged anywhere: no part of a mesh passes for the whole.
pub fn load(path: &Path) -> Result<Mesh, SceneError> {
    load_with_notes(path).map(|(mesh, _)| mesh)
}

/// Like [`load`], with what was left out, guessed or repaired, for people.
pub fn load_with_notes(path: &Path) -> Result<(Mesh, Vec<String>), SceneError> {
    load_with_colors(path, None)
}

/// Like [`load_with_notes`], with vertex colours encoded as `colors` says, instead of as the format's numbers tell: whole
/// ones as sRGB, floating-point ones as linear.
pub fn load_with_colors(path: &Path, colors: Option<ColorEncoding>) -> Result<(Mesh, Vec<String>), SceneError> {
    check_extension(path)?;
    parse(path, &bytes_of(path)?, colors)
}

/// Like [`load_with_colors`], from a file's bytes. The path tells the format, and where files are that it names.
///
/// Memory stays below some 100 times the number of bytes, whatever they say: what a header declares is held against them.
pub fn parse(path: &Path, bytes: &[u8], colors: Option<ColorEncoding>) -> Result<(Mesh, Vec<String>), SceneError> {
    let about = |error: SceneError| error.in_file(path);
    check_extension(path)?;
    let raw = match (extension(path).as_str(), colors) {
        ("obj", _) => obj::parse(bytes, colors),
        ("ply", _) => ply::parse(bytes, colors),
        (_, None) => gltf::parse(path, bytes),
        (_, Some(_)) => Err(SceneError::new("vertex colours of a glTF are linear by its specification")
            .with_remedy("leave `colors` out")),
    };
    let Assembled { mesh, notes, .. } = raw.and_then(assemble).map_err(about)?;
    Ok((mesh, notes))
}

/// A mesh of unchecked values, without colours and textures, made as sound as [`load`] makes those of files; with notes for
/// people.
pub(crate) fn sound(mesh: Mesh) -> Result<(Mesh, Vec<String>), SceneError> {
    let Mesh { positions, normals, texture_coordinates, triangles, .. } = mesh;
    let raw = RawMesh { positions, normals, texture_coordinates, triangles, ..RawMesh::default() };
    assemble(raw).map(|Assembled { mesh, notes, .. }| (mesh, notes))
}

/// A mesh file as a scene: of a glTF, what its first animation moves as a whole stands apart, and camera and lights come
/// along; of other formats, the mesh is all.
pub(crate) fn load_scene(path: &Path) -> Result<FileScene, SceneError> {
    let about = |error: SceneError| error.in_file(path);
    if !matches!(extension(path).as_str(), "gltf" | "glb") {
        let (mesh, notes) = load_with_notes(path)?;
        return Ok(FileScene { still: Some(mesh), moving: Vec::new(), camera: None, lights: Vec::new(), notes });
    }
    let gltf::RawScene { still, moving, camera, lights, mut notes } =
        gltf::parse_scene(path, &bytes_of(path)?).map_err(about)?;
    let mut sound = |raw: RawMesh| {
        let Assembled { mesh, notes: found, .. } = assemble(raw).map_err(about)?;
        let new: Vec<String> = found.into_iter().filter(|note| !notes.contains(note)).collect();
        notes.extend(new);
        Ok::<Mesh, SceneError>(mesh)
    };
    let still = still.map(&mut sound).transpose()?;
    let moving = moving
        .into_iter()
        .map(|(name, raw, motion)| Ok(MovingPart { name, mesh: sound(raw)?, motion }))
        .collect::<Result<_, SceneError>>()?;
    Ok(FileScene { still, moving, camera, lights, notes })
}

fn check_extension(path: &Path) -> Result<(), SceneError> {
    match extension(path).as_str() {
        known if EXTENSIONS.contains(&known) => Ok(()),
        extension => Err(SceneError::new(format!("`.{extension}` is no mesh format known here"))
            .with_remedy(format!("use one of: .{}", EXTENSIONS.join(", .")))
            .in_file(path)),
    }
}

/// Reads a glTF or GLB file with the skins and morph targets of its meshes, deformed by one of its animations.
///
/// The mesh is as [`load`] says, except that what has a skin stands where the skin's first joint puts it at rest: glTF
/// ignores the place of the node that holds it. The four joints of a vertex with the largest weights count, and weights
/// are made to add up to 1. Channels move nodes by translation, rotation and uniform scale, and weights
/// of morph targets; splines are sampled, 240 times per second or 64 times between two keys, whichever is fewer. Scales
/// that aren't uniform are errors.
///
/// An animation in which nothing moves is a pose: the mesh is returned in it, without a skin.
pub fn load_animated(path: &Path, animation: &Animation) -> Result<(Mesh, Option<Skin>), SceneError> {
    load_animated_with_notes(path, animation).map(|(mesh, skin, _)| (mesh, skin))
}

/// Like [`load_animated`], with what was left out, guessed or repaired, for people.
pub fn load_animated_with_notes(
    path: &Path,
    animation: &Animation,
) -> Result<(Mesh, Option<Skin>, Vec<String>), SceneError> {
    let about = |error: SceneError| error.in_file(path);
    let extension = extension(path);
    if !matches!(extension.as_str(), "gltf" | "glb") {
        return Err(about(
            SceneError::new(format!("`.{extension}` files have no animations"))
                .with_remedy("use a .gltf or .glb file, or leave `animation` out"),
        ));
    }
    let (raw, joints) = gltf::parse_animated(path, &bytes_of(path)?, animation).map_err(about)?;
    let Assembled { mut mesh, influences, morphs, flat_triangles, notes } = assemble(raw).map_err(about)?;
    let skin = Skin { joints, influences, morphs, flat_triangles };
    let reach = skin.reach(&mesh);
    if reach > f64::from(LARGEST_COORDINATE) {
        let problem = format!("animation {animation} may move vertices too far out to compute with, to {reach:.2e}");
        return Err(about(SceneError::new(problem).with_remedy("correct its keys in the program that wrote the file")));
    }
    if skin.moves() {
        return Ok((mesh, Some(skin), notes));
    }
    let posed = skin.deform(&mesh, 0.0);
    (mesh.positions, mesh.normals) = (posed.positions, posed.normals);
    Ok((mesh, None, notes))
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, SceneError> {
    let bytes =
        crate::input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(path))?;
    if bytes.is_empty() {
        return Err(SceneError::new("the file is empty").in_file(path));
    }
    Ok(bytes)
}
