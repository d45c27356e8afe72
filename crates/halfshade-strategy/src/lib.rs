//! What a strategy is: the trait, its parameters, the effects it models, and the contract every strategy passes.

pub mod contract;
pub mod effects;
pub mod params;
pub mod strategy;

pub use effects::{Effect, Effects};
pub use params::{Parameter, ParameterKind, Params, SpecError, Value};
pub use strategy::{Baked, Detail, Footprint, Info, Strategy, StrategyError};
