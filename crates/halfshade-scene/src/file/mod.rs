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
mod mesh_file;
mod reflectance;
mod source;
mod subsurface;
mod values;

pub use build::DEFAULT_SPHERE_COUNT;
pub use changes::Change;
pub(crate) use framing::camera_that_sees;
pub use mesh_file::from_mesh;
pub(crate) use source::stem;

use crate::{Scene, SceneError, keys, text};
use changes::changed;
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
