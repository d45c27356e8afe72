//! Ray-traced truth with its own standard error.
//!
//! Outgoing radiance of receivers under direct light with shadows,
//!
//! ```text
//! L = albedo/π · [ ∫ L_distant(ω) V(ω) max(n·ω, 0) dω + Σ over local lights ∫ L_light V(ω) max(n·ω, 0) dω ]
//! ```
//!
//! and, if asked for, the light that surfaces reflect b times on its way (see `paths.rs`), in the units of the scene's
//! radiance, one value and one standard error per receiver and channel. Glossy receivers add the same integrals over
//! their lobes towards the eye ([`halfshade_scene::EyeLobes`], see `glossy.rs`). This crate shares no code with the
//! strategies that it judges, since a shared mistake would cancel out in the score, but for the rays: those are held to
//! every triangle one by one in double precision.
//!
//! Receivers on translucent objects show light that entered elsewhere ([`halfshade_scene::Subsurface`], see `translucent.rs`): their
//! irradiance is the sum over points of the surface, each with rays and bounces of its own.
//!
//! - **Geometry**: the meshes, all of them, both faces; or the sphere sets, each sphere adjusted to the receiver.
//!   Their difference is the geometry error.
//! - **Rays**: those of [`halfshade_rays`], watertight, in a space where the scene has a fixed size about the origin.
//! - **Light**: constant, map, sun and spheres are separate integrals. Maps are sampled by cosine and by radiance, wide
//!   lights by solid angle and by cosine, combined with the balance heuristic.
//!   Lobes are sampled as well, up to exponents of 10^5.
//! - **Noise**: Owen-scrambled Sobol points, sixteen independent scramblings per value whose spread is the standard
//!   error, and the known unshadowed value as control variate.
//! - **Limits**: positions are single precision in the world; what is smaller than a few units in the last place of a
//!   receiver's coordinates casts no shadow on what it touches there. Where no sample is blocked although something is, the error reported is half a sample.
//!
//! ```
//! use glam::Vec3;
//! use halfshade_scene::{ReceiverBuffer, builtin, progress::Silent};
//! use halfshade_truth::{Options, Tracer, estimate};
//!
//! let scene = builtin::scene("one-sphere").expect("built in");
//! let mut receivers = ReceiverBuffer::default();
//! receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
//! let truth = estimate(&Tracer::new(&scene.frame(0)), receivers.view(), &Options::default(), &Silent);
//! assert!(truth.radiance.at(0).is_finite() && truth.samples == 1024);
//! ```

mod batch;
mod blocker_caps;
mod dipole;
mod directions;
mod environment;
mod estimate;
mod glossy;
mod hiders;
mod inward;
mod light_cap;
mod lights;
mod map_irradiance;
mod mixture;
mod options;
mod parts;
mod paths;
mod points;
mod receiver;
mod shadow_rays;
mod source;
mod space;
mod sphere_albedo;
mod sphere_irradiance;
mod tracer;
mod translucent;
mod visibility;

pub use estimate::{Estimate, estimate};
pub use hiders::{Hider, LEAST_SHARE, hiders};
pub use options::{Geometry, MAX_SAMPLES, Options, REPLICATES, Transport};
pub use parts::DRAWS;
pub use shadow_rays::{ShadowRay, shadow_rays};
pub use tracer::{Hit, Tracer};
