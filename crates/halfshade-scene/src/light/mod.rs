//! Light: an infinitely distant environment, and local spheres.

mod cap;
mod directional_cells;
mod environment;
mod environment_map;
mod octahedral;
mod sphere_light;

pub use cap::cap_irradiance;
pub use directional_cells::DirectionalCells;
pub use environment::{DistantLight, Environment, Sun};
pub use environment_map::EnvironmentMap;
pub use octahedral::{OctahedralGrid, OctahedralWeights};
pub use sphere_light::SphereLight;
