//! Once per scene: tables, sphere hierarchies, receiver clusters, colours and sample points of spheres.

pub(crate) mod clusters;
pub(crate) mod crossings;
pub(crate) mod directions;
pub(crate) mod geodesic;
pub(crate) mod ground;
pub(crate) mod hierarchy;
pub(crate) mod own;
pub(crate) mod reflections;
pub(crate) mod surface;

use super::settings::{Combination, ExponentialForm, GroundMode, Levels, OwnOcclusion, Ratios, Settings};
use clusters::ObjectClusters;
use glam::DVec3;
use ground::GroundTables;
use halfshade_scene::{Progress, Scene, spheres::AdjustRule};
use halfshade_sh::{
    blocker_table::{BlockerTable, Quantity},
    exponential::Exponential,
    kernel::BatchExponential,
};
use halfshade_strategy::StrategyError;
use hierarchy::Hierarchies;
use own::OwnTables;
use reflections::ReflectionTables;
use std::sync::Arc;

const NO_REFLECTING_TREES: &str =
    "reflections from a cut through the tree: covering between spheres is baked for spheres of one level";

/// How the blockers of a receiver become its visibility.
#[derive(Debug)]
pub(crate) enum Visibility {
    /// One product after another.
    Product,
    /// Each takes away its share, which so many points find.
    Shares { points: usize },
    /// Found along each of these directions, with the basis there times their solid angle.
    Traced { directions: Vec<(DVec3, Vec<f32>)> },
    /// Logarithms are summed.
    Exponential(BatchExponential),
}

/// How cuts through the hierarchy are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CutSettings {
    pub(crate) levels: Levels,
    /// Sine of the largest angular radius of a sphere that isn't a leaf.
    pub(crate) threshold_sine: f64,
    /// Whether parents are scaled, and to which spheres.
    pub(crate) ratios: Ratios,
    pub(crate) bands: usize,
}

/// Everything that holds for all frames of a scene.
#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) bands: usize,
    pub(crate) rule: AdjustRule,
    pub(crate) clamp: bool,
    /// Blockers by angular radius: logarithms for an exponential, else blockers less one.
    pub(crate) blockers: Arc<BlockerTable>,
    pub(crate) visibility: Visibility,
    /// Sphere sets by level; those of a frame that brings others are added.
    pub(crate) hierarchies: Hierarchies,
    /// Receiver clusters, object by object.
    pub(crate) clusters: Vec<Arc<ObjectClusters>>,
    pub(crate) cut: CutSettings,
    pub(crate) reflections: Option<ReflectionTables>,
    /// Objects without spheres, if they are to be seen.
    pub(crate) ground: Option<GroundTables>,
    /// Own occlusion, if meshes are to tell.
    pub(crate) own: Option<OwnTables>,
}

impl Tables {
    pub(crate) fn new(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Self, StrategyError> {
        let bands = settings.bands;
        progress.start("tables of blockers", 2);
        let build = |quantity| BlockerTable::build(bands, quantity).map(Arc::new).ok_or_else(|| unsupported(bands));
        let logarithm = Quantity::Logarithm { clip: settings.clip };
        let exponential = |form| {
            let exponential = batch_exponential(&settings.exponential(form, settings.magnitude_limit))?;
            Ok((Visibility::Exponential(exponential), logarithm))
        };
        let (visibility, quantity) = match settings.combination {
            Combination::Product => (Visibility::Product, Quantity::BlockerMinusOne),
            Combination::Shares => (Visibility::Shares { points: settings.points }, Quantity::BlockerMinusOne),
            Combination::Traced => {
                let directions = directions::even_directions(settings.directions);
                let directions = directions::weighted(bands, directions).collect();
                (Visibility::Traced { directions }, Quantity::BlockerMinusOne)
            }
            Combination::Series => exponential(ExponentialForm::Series)?,
            Combination::OptimalLinear => exponential(ExponentialForm::OptimalLinear)?,
            Combination::Hybrid => exponential(ExponentialForm::Hybrid)?,
            Combination::Quadratic => exponential(ExponentialForm::Quadratic)?,
        };
        let blockers = build(quantity)?;
        progress.advance(1);
        let branching = (settings.levels != Levels::Leaves).then_some(settings.branching);
        let mut hierarchies = Hierarchies::new(scene, settings.overlap, branching);
        let bounces = scene.bounces.min(settings.bounces);
        let reflections = if bounces == 0 {
            None
        } else if settings.levels == Levels::Tree {
            return Err(StrategyError::Unsupported(NO_REFLECTING_TREES.into()));
        } else {
            let exponential = settings.exponential(settings.reflection_form, settings.reflection_limit);
            let table = if quantity == logarithm { blockers.clone() } else { build(logarithm)? };
            let exponential = batch_exponential(&exponential)?;
            Some(ReflectionTables::new(scene, settings, bounces, exponential, table, &mut hierarchies))
        };
        let ground = match settings.ground {
            GroundMode::Ignored => None,
            GroundMode::Seen => GroundTables::new(scene, bands, settings.ground_directions),
        };
        let own = match settings.own {
            OwnOcclusion::Spheres => None,
            OwnOcclusion::Baked => {
                Some(OwnTables::new(scene, bands, settings.own_directions, settings.has_lamps(scene)))
            }
        };
        progress.advance(1);
        Ok(Self {
            bands,
            rule: settings.rule.into(),
            clamp: settings.clamp.is_on(),
            blockers,
            visibility,
            hierarchies,
            clusters: if settings.levels == Levels::Leaves { Vec::new() } else { clusters::clusters(scene) },
            cut: CutSettings {
                levels: settings.levels,
                threshold_sine: settings.cut_angle.to_radians().sin(),
                ratios: settings.ratios,
                bands,
            },
            reflections,
            ground,
            own,
        })
    }

    /// Log blockers by angular radius, if blockers are logarithms.
    pub(crate) fn logs(&self) -> Option<&BlockerTable> {
        match self.visibility {
            Visibility::Exponential(_) => Some(&self.blockers),
            Visibility::Product | Visibility::Shares { .. } | Visibility::Traced { .. } => None,
        }
    }
}

fn batch_exponential(exponential: &Exponential) -> Result<BatchExponential, StrategyError> {
    BatchExponential::new(exponential).ok_or_else(|| unsupported(exponential.bands()))
}

fn unsupported(bands: usize) -> StrategyError {
    StrategyError::Failed(format!("{bands} bands: there are kernels for 1 to 8"))
}
