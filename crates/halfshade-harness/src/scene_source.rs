//! SCENE: a built-in name.

use crate::HarnessError;
use halfshade_scene::{Mesh, Scene, builtin};
use std::path::Path;

/// The scene that `name` stands for. Files are relative to `folder`; `environment` lights mesh files only.
pub fn resolve(name: &str, _folder: &Path, _environment: Option<&str>) -> Result<Scene, HarnessError> {
    builtin::scene(name).ok_or_else(|| HarnessError::input(format!("unknown scene `{name}`; known: {}", known())))
}

/// The mesh in a file.
pub fn load_mesh(path: &Path) -> Result<(Mesh, Vec<String>), HarnessError> {
    Err(HarnessError::in_file(path, "mesh files cannot be read yet"))
}

fn known() -> String {
    builtin::SCENES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}
