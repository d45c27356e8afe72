//! Once per frame: spheres and lights about the frame's origin, the environment turned. It ends in plain data, see
//! [`frame`].

pub(crate) mod frame;
pub(crate) mod light;
pub(crate) mod surroundings;
