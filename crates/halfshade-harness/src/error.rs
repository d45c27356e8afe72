//! Errors around a measurement, in words a user can act on.

use crate::ReceiverKind;
use halfshade_scene::{SceneError, error::place, text::Excerpt};
use std::{
    ops::Range,
    path::{Path, PathBuf},
};

/// An error of the harness: the input, the output, or a file of ours that cannot be trusted.
#[derive(Debug, thiserror::Error)]
pub enum HarnessError {
    /// A scene, mesh or light that cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A mistake in a file or on the command line.
    #[error("{}{problem}{}", place(.path.as_deref(), *.line, .excerpt.as_deref()),
        .excerpt.as_ref().map(|it| format!("\n{it}")).unwrap_or_default())]
    Input {
        /// The file, if there is one.
        path: Option<PathBuf>,
        /// Line in the file, counted from 1.
        line: Option<usize>,
        /// That line with a mark under the place, of files that people write.
        excerpt: Option<Box<Excerpt>>,
        /// The mistake, and how to mend it.
        problem: String,
    },
    /// A file that cannot be read or written.
    #[error("{}: cannot {action}: {source}", .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// `read`, `write`, ..
        action: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
}

impl HarnessError {
    /// A mistake that concerns no file.
    pub fn input(problem: impl Into<String>) -> Self {
        Self::Input { path: None, line: None, excerpt: None, problem: problem.into() }
    }

    /// A view of a scene in which there is nothing that errors could be of.
    pub(crate) fn nothing_to_score(scene: &str, frame: usize, kind: ReceiverKind) -> Self {
        Self::input(format!("scene `{scene}`, frame {frame}: no {kind} to score; does the camera see anything?"))
    }

    /// A mistake in the file `path`.
    pub fn in_file(path: &Path, problem: impl Into<String>) -> Self {
        Self::Input { path: Some(path.to_owned()), line: None, excerpt: None, problem: problem.into() }
    }

    /// A mistake at `line` of the file `path`.
    pub fn at_line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self::Input { path: Some(path.to_owned()), line: Some(line), excerpt: None, problem: problem.into() }
    }

    /// A mistake at the bytes `span` of `text`, which is all of the file `path`.
    pub fn at(path: &Path, text: &str, span: Range<usize>, problem: impl Into<String>) -> Self {
        let excerpt = Box::new(Excerpt::of(text, span));
        let (path, line) = (Some(path.to_owned()), Some(excerpt.line));
        Self::Input { path, line, excerpt: Some(excerpt), problem: problem.into() }
    }

    /// A file that cannot be read or written.
    pub fn io(path: &Path, action: &'static str, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), action, source }
    }
}
