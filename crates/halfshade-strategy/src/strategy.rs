//! The trait, in three phases with three clocks, so that nobody hides work.

use crate::{Effects, Parameter, Params};
use halfshade_scene::{Frame, Progress, RadianceMut, Receivers, Scene};

/// What a strategy says of itself.
#[derive(Debug, Clone)]
pub struct Info {
    /// Short name, as in a SPEC: lower case, words joined by hyphens.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it is defined, as in `[Guerrero2007, 4.2]`.
    pub source: &'static str,
    /// Its parameters with defaults and ranges.
    pub parameters: Vec<Parameter>,
    /// What it can model.
    pub effects: Effects,
}

/// Why a strategy could not do what it was asked.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StrategyError {
    /// It cannot model this scene; the reason is shown in the table.
    #[error("unsupported: {0}")]
    Unsupported(String),
    /// Something went wrong.
    #[error("{0}")]
    Failed(String),
}

/// A method under comparison.
pub trait Strategy: Send + Sync {
    /// Name, parameters, effects.
    fn info(&self) -> Info;

    /// Whether it reads the objects' sphere sets; building them for those who don't would be a wait for nothing.
    fn needs_spheres(&self) -> bool {
        true
    }

    /// Offline, once per scene: tables and fields that hold for every frame. `params` holds a value for every parameter
    /// of [`Info::parameters`], within its range.
    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError>;
}

/// A strategy made ready for one scene.
pub trait Baked: Send + Sync {
    /// Bytes held, by part.
    fn footprint(&self) -> Footprint;

    /// Figures on what was baked that only this strategy has, such as the resolution it chose; found when asked for, off
    /// every clock.
    fn details(&self) -> Vec<Detail> {
        Vec::new()
    }

    /// Once per frame: poses, lights. Calling it twice with the same frame changes nothing.
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError>;

    /// Outgoing RGB radiance of a batch of receivers, toward the eye:
    /// `albedo/π · ∫ L V max(n·ω, 0) dω`, and the same over the lobes of glossy receivers ([`halfshade_scene::EyeLobes`]).
    /// Called from many threads at once on parts of the receivers; how they are split
    /// must change no bit. Allocates nothing per receiver.
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>);
}

/// A list of figures under a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Detail {
    /// What they are.
    pub name: String,
    /// The figures, in an order that the name tells.
    pub values: Vec<f64>,
}

/// Bytes by part.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Part name and its bytes.
    pub parts: Vec<(&'static str, usize)>,
}

impl Footprint {
    /// Sum over the parts.
    pub fn bytes(&self) -> usize {
        self.parts.iter().map(|(_, bytes)| bytes).sum()
    }
}
