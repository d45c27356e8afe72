//! One error for everything read from outside: which file, which line, what is wrong, what to do.

use std::path::PathBuf;

/// Error of a file or a description that a user gave.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}{}{problem}{}", .path.as_ref().map(|p| p.display().to_string()).unwrap_or_default(),
    match (.path, .line) { (Some(_), Some(l)) => format!(":{l}: "), (Some(_), None) => ": ".into(), _ => String::new() },
    .remedy.as_ref().map(|r| format!("; {r}")).unwrap_or_default())]
pub struct SceneError {
    /// The file concerned, if there is one.
    pub path: Option<PathBuf>,
    /// The line in that file, counted from 1, where the format has lines.
    pub line: Option<usize>,
    /// The fault.
    pub problem: String,
    /// Advice on what the user can do about it.
    pub remedy: Option<String>,
}

impl SceneError {
    /// An error that concerns no file.
    pub fn new(problem: impl Into<String>) -> Self {
        Self { path: None, line: None, problem: problem.into(), remedy: None }
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

    /// The same error, with advice.
    pub fn with_remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }
}
