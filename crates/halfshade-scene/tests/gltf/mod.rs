//! glTF.

mod geometry;
pub(crate) mod glb;
mod materials;
mod refusals;
mod skins;
mod stage;
