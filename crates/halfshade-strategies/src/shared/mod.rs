//! Code that several methods need and neither `halfshade-scene` nor `halfshade-sh` can have: each does without the other, and
//! without rays.

pub(crate) mod adjustment;
pub(crate) mod blockers;
pub(crate) mod by_mesh;
pub(crate) mod cosine_power;
pub(crate) mod cosine_spiral;
pub(crate) mod divided_light;
pub(crate) mod irradiance;
pub(crate) mod lamps;
pub(crate) mod light_cap;
pub(crate) mod light_space;
pub(crate) mod origin;
pub(crate) mod placed_lamps;
pub(crate) mod placed_spheres;
pub mod projected_light;
pub(crate) mod rotate;
pub(crate) mod scene_occlusion;
pub(crate) mod split_mix;
pub(crate) mod tangent_plane;
#[cfg(test)]
pub(crate) mod test_scenes;
pub(crate) mod triangle_rays;
pub(crate) mod vector;
pub(crate) mod vertex_vectors;
