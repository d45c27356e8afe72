//! Light: an infinitely distant environment, and local spheres.

mod cap;
mod environment;
mod environment_map;
mod sphere_light;

pub use cap::cap_irradiance;
pub use environment::{DistantLight, Environment, Sun};
pub use environment_map::EnvironmentMap;
pub use sphere_light::SphereLight;
