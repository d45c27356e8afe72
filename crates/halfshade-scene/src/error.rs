//! One error for everything read from outside: which file, which line, what is wrong, what to do.

use crate::text::Excerpt;
use std::{
    ops::Range,
    path::{Path, PathBuf},
};

/// Error of a file or a description that a user gave.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}{problem}{}{}", place(.path.as_deref(), *.line, .excerpt.as_deref()),
    .remedy.as_ref().map(|r| format!("; {r}")).unwrap_or_default(),
    .excerpt.as_ref().map(|e| format!("\n{e}")).unwrap_or_default())]
pub struct SceneError {
    /// The file concerned, if there is one.
    pub path: Option<PathBuf>,
    /// The line in that file, counted from 1, where the format has lines.
    pub line: Option<usize>,
    /// That line with a mark under the place, of files that people write.
    pub excerpt: Option<Box<Excerpt>>,
    /// The fault.
    pub problem: String,
    /// Advice on what the user can do about it.
    pub remedy: Option<String>,
}

impl SceneError {
    /// An error that concerns no file.
    pub fn new(problem: impl Into<String>) -> Self {
        Self { path: None, line: None, excerpt: None, problem: problem.into(), remedy: None }
    }

    /// The same error, about `path`.
    pub fn in_file(mut self, path: impl Into<PathBuf>) -> Self {
        self.path = Some(path.into());
        self
    }

    /// The same error, at `line` (counted from 1).
    pub fn at_line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    /// The same error, at the bytes `span` of `text`, which is all of the file.
    pub fn at(mut self, text: &str, span: Range<usize>) -> Self {
        let excerpt = Excerpt::of(text, span);
        self.line = Some(excerpt.line);
        self.excerpt = Some(Box::new(excerpt));
        self
    }

    /// The same error, with advice.
    pub fn with_remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }
}

/// `FILE: `, `FILE:LINE: ` or `FILE:LINE:COLUMN: `, as much as is known; nothing without a file.
pub fn place(path: Option<&Path>, line: Option<usize>, excerpt: Option<&Excerpt>) -> String {
    let Some(path) = path.map(Path::display) else { return String::new() };
    match (line, excerpt) {
        (_, Some(excerpt)) => format!("{path}:{}:{}: ", excerpt.line, excerpt.column),
        (Some(line), None) => format!("{path}:{line}: "),
        (None, None) => format!("{path}: "),
    }
}
