//! SCENE: a built-in name, a scene file, ours or that of another renderer, or a mesh file; and the light of a mesh file.

use crate::HarnessError;
use glam::Vec3;
use halfshade_scene::{
    Environment, Mesh, Scene, builtin,
    exchange::{mitsuba, pbrt},
    file::{self, Change},
    light::{self, ProbeOptions, Projection, Sky, load_probe},
    mesh, text,
};
use std::path::Path;

/// Endings of mesh files.
const MESHES: [&str; 4] = ["obj", "ply", "gltf", "glb"];

/// The light of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshLight<'a> {
    /// `sky` (the default, unless the file has lights of its own), `constant`, or an image, optionally followed by `:latlong` or `:angular`. Without that, a square
    /// image is an angular map.
    pub name: Option<&'a str>,
    /// Layer of an OpenEXR image.
    pub layer: Option<&'a str>,
    /// The largest radiance of an image.
    pub clamp: Option<f32>,
}

/// The scene that `name` stands for. Files are relative to `folder`. `light` is for mesh files, and only for them.
pub fn resolve(name: &str, folder: &Path, light: &MeshLight<'_>) -> Result<Scene, HarnessError> {
    resolve_changed(name, folder, light, &[])
}

/// The same of a scene file in which some values are others.
pub fn resolve_changed(
    name: &str,
    folder: &Path,
    light: &MeshLight<'_>,
    changes: &[Change],
) -> Result<Scene, HarnessError> {
    let path = folder.join(name);
    let ending = ending(&path);
    let is_mesh = MESHES.contains(&ending.as_str());
    if *light != MeshLight::default() && !is_mesh {
        let problem = format!(
            "scene `{name}` has its own light: an environment is for mesh files only; a scene file names image, layer and \
             clamp in its [environment]"
        );
        return Err(HarnessError::input(problem));
    }
    if let Some(Change { path, .. }) = changes.first().filter(|_| ending != "toml") {
        let problem = format!("`{path}` is a path into a scene file, and scene `{name}` is none");
        return Err(HarnessError::input(problem));
    }
    if let Some(scene) = builtin::scene(name) {
        return Ok(scene);
    }
    match ending.as_str() {
        "toml" => return Ok(file::load_changed(&path, changes)?),
        "xml" => return Ok(mitsuba::load(&path)?),
        "pbrt" => return Ok(pbrt::load(&path)?),
        _ => {}
    }
    if is_mesh {
        let (environment, mut notes) = environment(light, folder)?;
        let mut scene = file::from_mesh(&path, environment)?;
        scene.notes.append(&mut notes);
        return Ok(scene);
    }
    let known: Vec<&str> = builtin::SCENES.iter().map(|(name, _)| *name).collect();
    let meant = text::did_you_mean(name, known.iter().copied());
    Err(HarnessError::input(format!(
        "unknown scene `{name}`{meant}; built in: {}; or give a scene file (.toml, Mitsuba's .xml, pbrt-v4's .pbrt) or a mesh file (.{})",
        known.join(", "),
        MESHES.join(", .")
    )))
}

/// The mesh in a file, and what was repaired.
pub fn load_mesh(path: &Path) -> Result<(Mesh, Vec<String>), HarnessError> {
    Ok(mesh::load_with_notes(path)?)
}

/// The environment that `light` stands for, none where it says nothing, and what the user should know of its image.
fn environment(light: &MeshLight<'_>, folder: &Path) -> Result<(Option<Environment>, Vec<String>), HarnessError> {
    let text = light.name.unwrap_or("sky");
    let constructed = match (light.name, text) {
        (None, _) => Some(None),
        (_, "sky") => Some(Some(Sky::default().environment()?)),
        (_, "constant") => Some(Some(Environment::constant(Vec3::ONE))),
        _ => None,
    };
    if let Some(constructed) = constructed {
        if light.layer.is_some() || light.clamp.is_some() {
            let problem = format!("a layer and a largest radiance are for images, and the environment is `{text}`");
            return Err(HarnessError::input(problem));
        }
        return Ok((constructed, Vec::new()));
    }
    let (file, projection) = match text.rsplit_once(':') {
        Some((file, "latlong")) => (file, Some(Projection::LatLong)),
        Some((file, "angular")) => (file, Some(Projection::Angular)),
        _ => (text, None),
    };
    let path = folder.join(file);
    if !light::EXTENSIONS.contains(&ending(&path).as_str()) {
        let known = light::EXTENSIONS.join(", .");
        let problem = format!("unknown environment `{text}`; give `sky`, `constant`, or an image (.{known})");
        return Err(HarnessError::input(problem));
    }
    let layer = light.layer.map(str::to_owned);
    let options = ProbeOptions { projection, forward_degrees: 0.0, layer, clamp: light.clamp };
    let (map, notes) = load_probe(&path, &options)?;
    let notes = notes.into_iter().map(|note| format!("{}: {note}", path.display()));
    Ok((Some(Environment::map(map)), notes.collect()))
}

fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
