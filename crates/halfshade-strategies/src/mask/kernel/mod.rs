//! Inner loops: arrays and numbers in, numbers out. Spheres are seen by eight receivers side by side, directions are
//! looked into eight side by side.
//!
//! All points and directions are in light space: turned like the environment, about an origin of the frame's.

pub(crate) mod boxes;
pub(crate) mod bundle;
pub(crate) mod cap;
pub(crate) mod directions;
pub(crate) mod lamp;
pub(crate) mod lobe;
pub(crate) mod own;
