//! What shading reads: fields of the scene, light and places of the frame.

use super::{projection::HaarBasis, rows::Rows, shell::HaarShell, turn::Turn};
use crate::shadow_field::{
    arrangement::Arrangement,
    baking::{KnownMeshes, Source},
    settings::Product,
};
use halfshade_scene::Environment;

/// Fields of the scene, light and places of the frame.
pub(super) struct HaarFields {
    pub(super) source: Source,
    pub(super) basis: HaarBasis,
    pub(super) product: Product,
    /// Of the texels: x, y, z.
    pub(super) directions: [Vec<f32>; 3],
    /// Per object.
    pub(super) known: KnownMeshes<HaarShell, Rows>,
    /// Radiance times solid angle per texel: red, green, blue; and what it is of.
    pub(super) light: [Vec<f32>; 3],
    pub(super) known_light: Option<Environment>,
    pub(super) arrangement: Arrangement,
    /// Per object.
    pub(super) turns: Vec<Turn>,
}
