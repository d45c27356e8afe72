//! Scenes in the files of other renderers: written, so that another can confirm what the truth says, and read.

mod assembly;
pub mod mitsuba;
pub mod pbrt;
mod values;
mod view;
mod words;

/// Files of a scene that another renderer reads, in a folder of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Path within the folder, with `/` between its parts, and content of each file.
    pub files: Vec<(String, Vec<u8>)>,
    /// Notes on what is left out or approximated, for people.
    pub notes: Vec<String>,
}
