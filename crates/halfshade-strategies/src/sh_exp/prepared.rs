//! What shading reads: tables of the scene, spheres and light of the frame.

use super::{
    clusters::ObjectClusters,
    cuts::{CutSettings, Cuts},
    ground::Ground,
    levels::Hierarchies,
    light_product::LightProduct,
    moment::Moment,
    reflections::Reflections,
};
use halfshade_scene::spheres::AdjustRule;
use halfshade_sh::{blocker_table::BlockerTable, kernel::BatchExponential};
use std::sync::Arc;

/// How the blockers of a receiver become its visibility.
#[derive(Debug)]
pub(super) enum Combination {
    /// One product after another.
    Product,
    /// Each takes away its share.
    Shares { points: usize },
    /// None: found direction by direction.
    Traced { directions: usize },
    /// Logarithms are summed.
    Exponential(BatchExponential),
}

/// Tables of the scene, spheres and light of the frame.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) bands: usize,
    pub(super) rule: AdjustRule,
    pub(super) clamp: bool,
    pub(super) table: Arc<BlockerTable>,
    pub(super) combination: Combination,
    pub(super) light: LightProduct,
    pub(super) levels: Hierarchies,
    /// Receiver clusters, object by object.
    pub(super) clusters: Vec<Arc<ObjectClusters>>,
    pub(super) cut_settings: CutSettings,
    pub(super) cuts: Cuts,
    pub(super) reflections: Option<Reflections>,
    /// Objects without spheres, if they are to be seen.
    pub(super) ground: Option<Ground>,
    /// What everything above stands for.
    pub(super) moment: Option<Moment>,
}
