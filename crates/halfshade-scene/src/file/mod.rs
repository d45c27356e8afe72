//! Scene files, and scenes around a mesh file.
//!
//! A scene file is TOML. Its keys are the types of `document.rs` with their docs, which the guide prints (GUIDE.md) and
//! [`schema`] gives to editors; none but those is allowed. Paths are relative to the scene file. Places, radii and what scales
//! make of meshes stay within 1e12, so that single precision can multiply them.
//!
//! ```toml
//! [[object]]
//! mesh = "bunny.obj"
//! albedo = [0.7, 0.5, 0.4]
//!
//! [[object]]
//! shape = "plane"
//! scale = 3
//!
//! [environment]
//! image = "probe.hdr"
//! ```

mod build;
mod changes;
mod document;
mod environment;
mod framing;
mod reflectance;
mod source;
mod subsurface;
mod values;

pub use build::DEFAULT_SPHERE_COUNT;
pub use changes::Change;

use crate::{Environment, Object, Pose, Scene, SceneError, builtin, keys, mesh, text};
use changes::changed;
use glam::Vec3;
use source::Source;
use std::path::Path;

/// Reads a scene file and all that it names; sphere sets are not built yet.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    load_changed(path, &[])
}

/// The same of a file in which some values are others.
///
/// # Errors
/// Those of the file, and a change whose path leads nowhere.
pub fn load_changed(path: &Path, changes: &[Change]) -> Result<Scene, SceneError> {
    let mut text = text::read(path)?;
    if !changes.is_empty() {
        text = changed(&text, changes).map_err(|error| error.in_file(path))?;
    }
    let source = Source::new(path, &text);
    let document = source.parse()?;
    build::scene(&source, document)
}

/// The JSON Schema of scene files.
pub fn schema() -> serde_json::Value {
    keys::schema::<document::Document>()
}

/// The scene of a mesh file by itself: the mesh at its own scale and place, a grey ground plane under its lowest point,
/// a camera that sees all of it. The mesh casts shadows by [`DEFAULT_SPHERE_COUNT`] spheres.
pub fn from_mesh(path: &Path, environment: Environment) -> Result<Scene, SceneError> {
    let (mesh, notes) = mesh::load_with_notes(path)?;
    let (min, max) = mesh.bounds().ok_or_else(|| SceneError::new("the mesh is empty").in_file(path))?;
    let name = source::stem(path);
    let center = 0.5 * (min + max);
    let ground = Object::new("ground", builtin::shapes::plane(128)).albedo(Vec3::splat(0.5)).pose(Pose {
        // Wide enough that the penumbra of a light 30 degrees high ends on it.
        scale: 1.5 * (max - min).length(),
        ..Pose::from_translation(Vec3::new(center.x, min.y, center.z))
    });
    let object = Object::new(name.clone(), mesh).albedo(Vec3::splat(0.8)).sphere_count(DEFAULT_SPHERE_COUNT);
    Ok(Scene {
        camera: framing::camera_on(min.as_dvec3(), max.as_dvec3()).map_err(|error| error.in_file(path))?,
        notes: source::named_notes(path, notes),
        ..Scene::at_rest(name, vec![object, ground], environment)
    })
}
