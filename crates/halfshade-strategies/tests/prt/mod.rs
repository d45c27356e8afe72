//! Precomputed radiance transfer against closed forms and the truth.

mod closed_forms;
mod compression;
mod convergence;
mod ends;
mod gloss;
mod lamps;
mod motion;
mod ringing;
mod scenes;
mod subsurface;
mod volume;
