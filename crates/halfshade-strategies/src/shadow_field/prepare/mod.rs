//! Once per frame: where objects and lights are, distant light in the basis, rotations between the spaces. It ends in
//! plain data (`frame.rs`, `sh.rs`, `haar.rs`).

pub(crate) mod cube_light;
pub(crate) mod frame;
pub(crate) mod haar;
pub(crate) mod placement;
pub(crate) mod sh;
pub(crate) mod sh_light;
pub(crate) mod texel_map;
