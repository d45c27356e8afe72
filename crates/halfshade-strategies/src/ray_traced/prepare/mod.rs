//! Once per frame: a hierarchy over all triangles, and light to draw directions from.

pub(crate) mod light_sampler;
pub(crate) mod occlusion;
