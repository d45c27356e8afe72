//! TOML files whose keys are declared by types.
//!
//! One declaration, a type with its docs that derives `Deserialize` and `JsonSchema`, is all of it: what a file may hold
//! ([`parse`]), what an editor offers ([`schema`]), and what the guide prints ([`reference()`]). A file is held to the schema before
//! it becomes a value, so that a mistake is told in words of the file, at its place, with the name that was probably meant.

mod check;
mod reference;
mod schema;
mod spanned;
mod words;

pub use reference::reference;
pub use schema::schema;
pub use spanned::Spanned;

use crate::SceneError;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use toml::de::DeTable;

/// The value that a file's `text` stands for.
///
/// # Errors
/// Text that is no TOML, what the schema of `T` doesn't allow, and what `T` refuses; at its place, without the file's name.
pub fn parse<T: DeserializeOwned + JsonSchema>(text: &str) -> Result<T, SceneError> {
    let located = |error: toml::de::Error| {
        let problem = SceneError::new(error.message().trim());
        error.span().map_or(problem.clone(), |span| problem.at(text, span))
    };
    let document = DeTable::parse(text).map_err(located)?;
    if let Some(mistake) = check::first_mistake(&schema::<T>(), &document) {
        return Err(SceneError::new(mistake.problem).at(text, mistake.span));
    }
    toml::from_str(text).map_err(located)
}

#[cfg(test)]
mod tests;
