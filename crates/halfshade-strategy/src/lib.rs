//! The definition of a strategy: the trait, its parameters, the effects it models, and the contract every strategy passes.
//!
//! A strategy's [`Info`] says what can be set and what it can model; a SPEC is read by it:
//!
//! ```
//! use halfshade_strategy::{Effects, Info, settings};
//!
//! settings! {
//!     /// Everything that can be set.
//!     struct Settings {
//!         /// bands of visibility
//!         "bands" => bands: usize = 4, in 1..=8;
//!     }
//! }
//!
//! let parameters = Settings::parameters();
//! let info = Info { name: "mine", summary: "", source: "", parameters, presets: &[], stages: &[], effects: Effects::default() };
//! assert_eq!(Settings::read(&info.parse("bands=6").unwrap()).bands, 6);
//! let mistake = info.parse("band=6").unwrap_err().to_string();
//! assert_eq!(mistake, "unknown parameter `band` (did you mean `bands`?); known: bands");
//! ```

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
