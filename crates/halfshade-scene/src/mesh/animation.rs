//! The choice of one of a file's animations.

use schemars::JsonSchema;
use serde::Deserialize;
use std::fmt;

/// One of the animations of a glTF file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected the number or the name of an animation")]
pub enum Animation {
    /// By its place in the file, from 0.
    Number(usize),
    /// By its name.
    Name(String),
}

impl fmt::Display for Animation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => write!(f, "`{name}`"),
        }
    }
}
