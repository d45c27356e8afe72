//! The text of a scene file, and errors that name its lines.

use super::document::Document;
use crate::keys::{self, Spanned};
use crate::{Mesh, SceneError, Texture};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene file's path and text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    text: &'a str,
}

impl<'a> Source<'a> {
    pub(super) fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, text }
    }

    pub(super) fn parse(&self) -> Result<Document, SceneError> {
        keys::parse(self.text).map_err(|error| error.in_file(self.path))
    }

    /// An error about a piece of the text.
    pub(super) fn error(&self, span: Range<usize>, problem: impl Into<String>) -> SceneError {
        SceneError::new(problem).in_file(self.path).at(self.text, span)
    }

    /// The error of a file that the scene names: about that file; where it can't be read at all, where it is named as
    /// well.
    pub(super) fn named_at(&self, name: &Spanned<String>, error: SceneError) -> SceneError {
        let is_missing = error.path.as_ref().is_some_and(|path| !path.is_file());
        if is_missing { self.error(name.span(), error.to_string()) } else { error }
    }

    /// The texture at `path`, which the value of `key` names, for a mesh that has a place for it.
    pub(super) fn texture(
        &self,
        key: &str,
        path: &Spanned<String>,
        mesh: &Mesh,
        name: &str,
    ) -> Result<Arc<Texture>, SceneError> {
        if mesh.texture_coordinates.is_empty() {
            let problem = format!("`{name}` has no texture coordinates, so that {key} has no place");
            return Err(self.error(path.span(), problem));
        }
        let texture = Texture::load(&self.resolve(path.get_ref())).map_err(|error| self.named_at(path, error))?;
        Ok(Arc::new(texture))
    }

    /// A path as the file means it: relative to the file.
    pub(super) fn resolve(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }
}

/// Notes that say which file they are about.
pub(super) fn named_notes(path: &Path, notes: Vec<String>) -> Vec<String> {
    notes.into_iter().map(|note| format!("{}: {note}", path.display())).collect()
}

/// A file's name without its extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
