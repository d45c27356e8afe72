//! Once per frame: light to draw directions from.

pub(crate) mod light_sampler;
pub(crate) mod light_tree;
pub(crate) mod neighbours;
