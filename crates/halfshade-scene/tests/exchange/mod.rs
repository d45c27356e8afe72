//! Scenes of other renderers: what is written and read again is the same, what is read is what they mean, and damage is told.

mod damaged;
mod mitsuba;
mod pbrt;

use halfshade_scene::{Scene, SceneError, exchange};
use std::path::Path;

/// Writes a file, and the folders that it lies in.
fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// Reads a scene whose file has this name and text.
fn read(name: &str, text: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), name, text);
    load(&folder.path().join(name))
}

fn load(path: &Path) -> Result<Scene, SceneError> {
    if path.extension().is_some_and(|ending| ending == "xml") {
        exchange::mitsuba::load(path)
    } else {
        exchange::pbrt::load(path)
    }
}

/// Whether a note speaks of this line and has this part.
fn notes(scene: &Scene, line: usize, part: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(&format!(":{line}: ")) && note.contains(part))
}
