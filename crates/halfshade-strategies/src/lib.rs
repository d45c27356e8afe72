//! The methods under comparison, one folder each. They never import each other: what two need lives in `halfshade-scene`
//! or `halfshade-sh`; what neither can have, in `shared`.
//!
//! Baked once, prepared for a frame, a strategy shades receivers:
//!
//! ```
//! use glam::Vec3;
//! use halfshade_scene::{Environment, Object, RadianceBuffer, ReceiverBuffer, Scene, builtin::shapes, progress::Silent};
//! use halfshade_strategies::Unshadowed;
//! use halfshade_strategy::Strategy;
//!
//! let ground = Object::new("ground", shapes::plane(1)).albedo(Vec3::ONE);
//! let scene = Scene::at_rest("white", vec![ground], Environment::constant(Vec3::ONE));
//! let mut baked = Unshadowed.bake(&scene, &Unshadowed.info().defaults(), &Silent)?;
//! let frame = scene.frame(0);
//! let receivers = ReceiverBuffer::vertices(&frame);
//! let mut radiance = RadianceBuffer::zeros(receivers.len());
//! baked.prepare(&frame)?.shade(receivers.view(), radiance.view_mut());
//! // What is white and sees constant light alone is as bright as the light.
//! assert!(radiance.at(0).abs_diff_eq(Vec3::ONE, 1e-3));
//! # Ok::<(), halfshade_strategy::StrategyError>(())
//! ```

pub mod analytic;
pub mod cosine_lobe;
pub mod mask;
pub mod prt;
pub mod ray_traced;
pub mod sh_exp;
pub mod shadow_field;
mod shared;
pub mod unshadowed;

pub use analytic::Analytic;
pub use cosine_lobe::CosineLobe;
pub use mask::Mask;
pub use prt::Prt;
pub use ray_traced::RayTraced;
pub use sh_exp::ShExp;
pub use shadow_field::ShadowField;
pub use shared::projected_light;
pub use unshadowed::Unshadowed;
