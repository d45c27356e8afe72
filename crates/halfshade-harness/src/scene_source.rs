//! SCENE: a built-in name, a scene file, or a mesh file; and the light of a mesh file.

use crate::HarnessError;
use glam::Vec3;
use halfshade_scene::{
    Environment, Mesh, Scene, builtin, file,
    light::{Projection, Sky, load_probe},
    mesh,
};
use std::path::Path;

/// Endings of mesh files.
const MESHES: [&str; 4] = ["obj", "ply", "gltf", "glb"];
/// Endings of light probes.
const PROBES: [&str; 2] = ["hdr", "exr"];

/// The scene that `name` stands for. Files are relative to `folder`.
///
/// `environment` lights mesh files, and only them: `sky` (the default), `constant`, or an image relative to `folder`,
/// optionally followed by `:latlong` or `:angular`. Without that, a square image is an angular map.
pub fn resolve(name: &str, folder: &Path, environment: Option<&str>) -> Result<Scene, HarnessError> {
    let path = folder.join(name);
    let ending = ending(&path);
    let is_mesh = MESHES.contains(&ending.as_str());
    if environment.is_some() && !is_mesh {
        let problem = format!("scene `{name}` has its own light: an environment is for mesh files only");
        return Err(HarnessError::input(problem));
    }
    if let Some(scene) = builtin::scene(name) {
        return Ok(scene);
    }
    if ending == "toml" {
        return Ok(file::load(&path)?);
    }
    if is_mesh {
        let light = light(environment.unwrap_or("sky"), folder)?;
        return Ok(file::from_mesh(&path, light)?);
    }
    let known: Vec<&str> = builtin::SCENES.iter().map(|(name, _)| *name).collect();
    Err(HarnessError::input(format!(
        "unknown scene `{name}`; built in: {}; or give a scene file (.toml) or a mesh file (.{})",
        known.join(", "),
        MESHES.join(", .")
    )))
}

/// The mesh in a file, and what was repaired.
pub fn load_mesh(path: &Path) -> Result<(Mesh, Vec<String>), HarnessError> {
    Ok(mesh::load_with_notes(path)?)
}

/// The light that `text` stands for (see [`resolve`]).
fn light(text: &str, folder: &Path) -> Result<Environment, HarnessError> {
    match text {
        "sky" => return Ok(Sky::default().environment()?),
        "constant" => return Ok(Environment::constant(Vec3::ONE)),
        _ => {}
    }
    let (file, projection) = match text.rsplit_once(':') {
        Some((file, "latlong")) => (file, Some(Projection::LatLong)),
        Some((file, "angular")) => (file, Some(Projection::Angular)),
        _ => (text, None),
    };
    let path = folder.join(file);
    if !PROBES.contains(&ending(&path).as_str()) {
        let problem = format!("unknown environment `{text}`; give `sky`, `constant`, or an image (.hdr, .exr)");
        return Err(HarnessError::input(problem));
    }
    let map = match projection {
        Some(projection) => load_probe(&path, projection, 0.0)?,
        // Which one fits is decided by the shape; where neither does, the error of the usual one is told.
        None => match load_probe(&path, Projection::LatLong, 0.0) {
            Ok(map) => map,
            Err(error) => load_probe(&path, Projection::Angular, 0.0).map_err(|_| error)?,
        },
    };
    Ok(Environment::map(map))
}

fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
