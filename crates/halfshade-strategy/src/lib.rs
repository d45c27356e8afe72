//! The definition of a strategy: the trait, its parameters, the effects it models, and the contract every strategy passes.

pub mod contract;
pub mod effects;
pub mod info;
mod macros;
pub mod parameter;
pub mod params;
pub mod settings;
pub mod strategy;

pub use effects::{Effect, Effects};
pub use info::Info;
pub use parameter::{Parameter, ParameterKind, Preset, Stage, Value, Word};
pub use params::{Params, SpecError};
pub use strategy::{Baked, Batching, Detail, Footprint, Prepared, Shading, Strategy, StrategyError};
