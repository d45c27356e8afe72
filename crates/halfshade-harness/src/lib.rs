//! Experiments: plan, run, score, time, store, report.
//!
//! The harness never names a strategy: whoever calls it hands in the list of all, with the other tools of [`run::run`]. An experiment
//! is a file:
//!
//! ```
//! use halfshade_harness::Experiment;
//! use std::path::Path;
//!
//! let text = r#"
//! name = "soft"
//! claim = "bands matter"
//! [truth]
//! samples = 256
//! [[scene]]
//! name = "vases"
//! [[strategy]]
//! name = "mine"
//! bands = [3, 4]
//! "#;
//! let experiment = Experiment::parse(text, Path::new("soft.toml"))?;
//! assert_eq!((experiment.frames.as_slice(), experiment.strategies.len()), (&[0][..], 1));
//! let mistake = Experiment::parse(&text.replace("samples", "sampels"), Path::new("soft.toml")).unwrap_err();
//! assert!(mistake.to_string().starts_with("soft.toml:5:1: unknown key `sampels` (did you mean `samples`?)"));
//! # Ok::<(), halfshade_harness::HarnessError>(())
//! ```

pub mod ability;
pub mod check;
pub mod classes;
pub mod clock;
pub mod device;
pub mod error;
pub mod errors;
pub mod experiment;
pub mod file_names;
pub mod frame_time;
pub mod image_io;
pub mod image_metrics;
pub mod inputs;
pub mod intervals;
pub mod journal;
pub mod left_out;
pub mod machine;
pub mod merge;
pub mod metrics;
mod noise;
pub mod out_folder;
pub mod output;
pub mod part;
pub mod picture_colors;
pub mod projection;
pub mod reference;
mod reference_key;
pub mod report;
pub mod results;
pub mod run;
pub mod scene_source;
pub mod shading;
pub mod sphere_fit;
pub mod ssim;
pub mod stability;
pub mod statistics;
pub mod threads;
pub mod tune;
pub mod variant;
pub mod weights;

#[cfg(test)]
mod toy;
#[cfg(test)]
mod traced;

pub use clock::{Clock, SystemClock};
pub use device::{Device, GraphicsDevice};
pub use error::HarnessError;
pub use errors::Reference;
pub use experiment::{Experiment, Published, ReceiverKind, ReferenceKind};
pub use image_io::Picture;
pub use intervals::Intervals;
pub use metrics::Metrics;
pub use part::Part;
pub use results::Results;
pub use variant::Variant;
pub use weights::{ReceiverWeights, Weighting};
