//! Ray-traced truth with its own standard error.
//!
//! Direct light with shadows at diffuse receivers, by Monte Carlo integration over rays that obvhs traces. This crate
//! shares no code with the strategies that it judges: a shared mistake would cancel out in the score.

mod batch;
mod caps;
mod directions;
mod environment;
mod estimate;
mod inward;
mod lights;
mod map_irradiance;
mod points;
mod receiver;
mod shadow_rays;
mod space;
mod sphere_irradiance;
mod tracer;
mod triangle;

pub use estimate::{Estimate, Geometry, MAX_SAMPLES, Options, REPLICATES, Transport, estimate};
pub use shadow_rays::{ShadowRay, shadow_rays};
pub use tracer::{Hit, Surface, Tracer};
