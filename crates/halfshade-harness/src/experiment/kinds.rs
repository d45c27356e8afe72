//! Kinds of receivers and of references, by the names that experiment files give them.

use halfshade_scene::text;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, fmt, num::NonZeroUsize, str::FromStr};

/// Points that are scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ReceiverKind {
    /// Every vertex of every object.
    Vertices,
    /// Surface points that the camera sees, one per pixel.
    Pixels,
}

impl fmt::Display for ReceiverKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vertices => "vertices",
            Self::Pixels => "pixels",
        })
    }
}

/// References by kind: differences between them take a strategy's error apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReferenceKind {
    /// `mesh`: the truth itself.
    Mesh,
    /// `spheres`: blockers are the sphere sets. What is left is not geometry.
    Spheres,
    /// `bands=n`: sphere sets, and the environment limited to n bands of spherical harmonics.
    /// Strategies whose parameter `bands` has another value are left out.
    Bands(NonZeroUsize),
    /// `mesh-bands=n`: the meshes under such an environment. What an experiment calls `bands` for strategies that read no spheres.
    MeshBands(NonZeroUsize),
    /// `bands`: as above, n being the strategy's own parameter `bands`; strategies without it are left out.
    OwnBands,
}

impl ReferenceKind {
    /// Bands of its light, if they are few.
    pub fn bands(self) -> Option<NonZeroUsize> {
        match self {
            Self::Bands(bands) | Self::MeshBands(bands) => Some(bands),
            Self::Mesh | Self::Spheres | Self::OwnBands => None,
        }
    }

    /// Whether sphere sets block in place of meshes.
    pub fn has_spheres(self) -> bool {
        matches!(self, Self::Spheres | Self::Bands(_))
    }
}

impl fmt::Display for ReferenceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh => f.write_str("mesh"),
            Self::Spheres => f.write_str("spheres"),
            Self::Bands(n) => write!(f, "bands={n}"),
            Self::MeshBands(n) => write!(f, "mesh-bands={n}"),
            Self::OwnBands => f.write_str("bands"),
        }
    }
}

impl FromStr for ReferenceKind {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "mesh" => Ok(Self::Mesh),
            "spheres" => Ok(Self::Spheres),
            "bands" => Ok(Self::OwnBands),
            _ => word
                .strip_prefix("bands=")
                .and_then(|n| n.parse().ok())
                .map(Self::Bands)
                .ok_or_else(|| text::unknown("reference", word, ["mesh", "spheres", "bands", "bands=N"])),
        }
    }
}

impl<'de> Deserialize<'de> for ReferenceKind {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

impl JsonSchema for ReferenceKind {
    fn schema_name() -> Cow<'static, str> {
        "ReferenceKind".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": "^(mesh|spheres|bands|bands=[1-9][0-9]*)$" })
    }
}
