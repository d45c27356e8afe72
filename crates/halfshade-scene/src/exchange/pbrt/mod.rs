//! Scenes of pbrt-v4 \[Pharr2023\], as far as they can be scenes here.

mod import;
mod lights;
mod materials;
mod parameters;
mod shapes;
mod tokens;

pub use import::load;
