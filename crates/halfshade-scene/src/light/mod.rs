//! Light: an infinitely distant environment, and local spheres.

mod angular;
mod cap;
mod directional_cells;
mod environment;
mod environment_map;
mod image_file;
mod octahedral;
mod probe;
mod sky;
mod sphere_light;

pub use cap::cap_irradiance;
pub use directional_cells::DirectionalCells;
pub use environment::{DistantLight, Environment, Sun};
pub use environment_map::EnvironmentMap;
pub use octahedral::{OctahedralGrid, OctahedralWeights};
pub(crate) use probe::load_picture;
pub use probe::{EXTENSIONS, ProbeOptions, Projection, load_probe};
pub(crate) use sky::SUN_ANGULAR_RADIUS;
pub use sky::{KILOCANDELAS_PER_UNIT, Sky};
pub use sphere_light::SphereLight;

use glam::Vec3;

/// Whether all channels are equal.
pub fn is_grey(color: Vec3) -> bool {
    color.x == color.y && color.y == color.z
}

/// Relative luminance of linear Rec. 709 radiance: 0.2126 R + 0.7152 G + 0.0722 B, in the unit of the radiance.
pub fn luminance(radiance: Vec3) -> f32 {
    radiance.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
