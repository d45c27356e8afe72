//! The truth against closed forms, against itself, and at the extremes.

mod bounces;
mod closed_forms;
mod cutouts;
mod estimator;
mod gloss;
mod ground_scale;
mod hiders;
mod one_alone;
mod scenes;
mod self_shadowing;
mod still;
mod subsurface;
