//! A frame as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::kernel::{
    blocker::Blocker,
    light::{BaseByNormal, DistantLightByNormal},
    sun::SunLight,
};
use super::{
    BakedScene,
    bake::Visibility,
    prepare::{self, cuts::CutOf},
};
use glam::{DMat3, DVec3};
use halfshade_scene::{Frame, Receivers, spheres::AdjustRule};
use halfshade_sh::{blocker_table::BlockerTable, kernel::BatchExponential};
use halfshade_strategy::StrategyError;

/// Tables that hold for all frames of a scene.
#[derive(Debug, Clone, Copy)]
pub struct SceneArrays<'a> {
    /// Bands of visibility.
    pub bands: usize,
    /// Treatment of spheres that cut the tangent plane.
    pub rule: AdjustRule,
    /// Whether direct light is held between 0 and unshadowed.
    pub clamp: bool,
    /// Zonal vectors of blockers by angular radius: logarithms, or blockers less one.
    pub blockers: &'a BlockerTable,
    /// How blockers combine.
    pub combination: CombinationArrays<'a>,
    /// Whether spheres radiate, too.
    pub reflects: bool,
    /// Whether objects without spheres are seen.
    pub sees_ground: bool,
}

/// How blockers become visibility.
#[derive(Debug, Clone, Copy)]
pub enum CombinationArrays<'a> {
    /// Logarithms are summed, and this is their exponential.
    Exponential(&'a BatchExponential),
    /// One product after another.
    Product,
    /// Each by the share of it that no other hides.
    Shares,
    /// Traced.
    Traced,
}

/// Data of the frame that was prepared last.
#[derive(Debug, Clone, Copy)]
pub struct FrameArrays<'a> {
    /// Light that is multiplied with visibility, in light space.
    pub light: &'a DistantLightByNormal,
    /// How often the light has changed since the scene was baked.
    pub light_changes: u32,
    /// Rotation of light space: `rotation · (point - center)` of a point in world space.
    pub rotation: DMat3,
    /// Its origin.
    pub center: DVec3,
}

impl BakedScene {
    /// Makes `frame` the frame of [`Self::frame_arrays`].
    pub fn prepare_frame(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        if !frame.lights.is_empty() {
            return Err(StrategyError::Unsupported(super::NO_LOCAL_LIGHTS.into()));
        }
        prepare::prepare(&mut self.tables, &mut self.data, frame)
    }

    /// Tables of the scene.
    pub fn scene_arrays(&self) -> SceneArrays<'_> {
        let tables = &self.tables;
        SceneArrays {
            bands: tables.bands,
            rule: tables.rule,
            clamp: tables.clamp,
            blockers: &tables.blockers,
            combination: match &tables.visibility {
                Visibility::Exponential(exponential) => CombinationArrays::Exponential(exponential),
                Visibility::Product => CombinationArrays::Product,
                Visibility::Shares { .. } => CombinationArrays::Shares,
                Visibility::Traced { .. } => CombinationArrays::Traced,
            },
            reflects: tables.reflections.is_some(),
            sees_ground: tables.ground.is_some(),
        }
    }

    /// Light and space of the frame.
    pub fn frame_arrays(&self) -> FrameArrays<'_> {
        let (space, light) = (&self.data.space, &self.data.light);
        FrameArrays {
            light: &light.by_normal,
            light_changes: light.changes,
            rotation: space.rotation,
            center: space.center,
        }
    }

    /// The blockers of each cut, in light space.
    pub fn cuts(&self) -> impl Iterator<Item = &[Blocker]> {
        self.data.cuts.all()
    }

    /// The cut of each receiver; `None` if they all share the first. Stays the same from frame to frame.
    pub fn cut_of(&self, receivers: Receivers<'_>) -> Option<Vec<u32>> {
        self.data.cuts.of(receivers, &self.data.space, CutOf::Cluster)
    }
}
