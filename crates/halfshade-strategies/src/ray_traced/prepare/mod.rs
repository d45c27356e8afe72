//! Once per frame: a hierarchy over all triangles, and light to draw directions from.

pub(crate) mod light_sampler;
pub(crate) mod light_tree;
pub(crate) mod neighbours;
pub(crate) mod occlusion;
