//! What shading reads: fields of the scene, light and places of the frame.

use super::{projection::ShBasis, shell::ShShell};
use crate::shadow_field::{
    arrangement::Arrangement,
    baking::{KnownMeshes, Source},
};
use halfshade_scene::Environment;
use halfshade_sh::blocker_table::BlockerTable;

/// What an object's own occlusion is kept as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OwnKind {
    /// What the object hides above the vertex, to be multiplied with ρ̂ when shading [Tamura2006, figure 3].
    Blocked,
    /// Visibility times the cosine over π, projected as it is; for receivers that are vertices.
    Transfer,
}

/// Fields of the scene, light and places of the frame.
pub(super) struct ShFields {
    pub(super) bands: usize,
    pub(super) source: Source,
    pub(super) basis: ShBasis,
    pub(super) own_kind: OwnKind,
    pub(super) table: BlockerTable,
    /// Clamped cosine over π by band, times the rotation's factor: ρ̂.
    pub(super) cosine: Vec<f32>,
    /// Per object.
    pub(super) known: KnownMeshes<ShShell, Vec<f32>>,
    /// S_d: coefficient by coefficient, red, green, blue; and what it is of.
    pub(super) light: Vec<[f32; 3]>,
    pub(super) known_light: Option<Environment>,
    pub(super) arrangement: Arrangement,
    /// Per object the blocks of the SH rotation from object space into light space, band by band, row by row.
    pub(super) rotations: Vec<Vec<f32>>,
}
