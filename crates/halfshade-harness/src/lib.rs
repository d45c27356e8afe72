//! Experiments: plan, run, score, time, store, report.
//!
//! The harness never names a strategy: whoever calls it hands in the list of all.

pub mod clock;
pub mod error;
pub mod experiment;
pub mod image_io;
pub mod image_metrics;
pub mod journal;
pub mod metrics;
pub mod output;
pub mod results;
pub mod statistics;
pub mod variant;

#[cfg(test)]
mod toy;

pub use clock::{Clock, SystemClock};
pub use error::HarnessError;
pub use experiment::{Experiment, Published, ReceiverKind, ReferenceKind};
pub use image_io::Picture;
pub use metrics::{Metrics, Reference};
pub use results::Results;
pub use variant::Variant;
