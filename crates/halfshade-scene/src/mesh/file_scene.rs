//! Content of a mesh file beside one mesh: parts that move, a camera, lights.

use super::Mesh;
use crate::{Camera, Motion};
use glam::DVec3;

/// A mesh file as a scene.
#[derive(Debug, Clone)]
pub(crate) struct FileScene {
    /// All that stands still.
    pub(crate) still: Option<Mesh>,
    /// Parts that move as a whole, each in its own space.
    pub(crate) moving: Vec<MovingPart>,
    pub(crate) camera: Option<Camera>,
    pub(crate) lights: Vec<Punctual>,
    /// Notes on what was left out, guessed or repaired, for people.
    pub(crate) notes: Vec<String>,
}

/// A part of a file that moves.
#[derive(Debug, Clone)]
pub(crate) struct MovingPart {
    pub(crate) name: String,
    pub(crate) mesh: Mesh,
    pub(crate) motion: Motion,
}

/// A light without a size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Punctual {
    pub(crate) kind: PunctualKind,
    /// Linear Rec. 709: candela of a point, lux of a direction.
    pub(crate) intensity: DVec3,
}

/// Place of a light without a size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PunctualKind {
    Point {
        position: DVec3,
    },
    /// A unit vector toward the light.
    Directional {
        toward: DVec3,
    },
}
