//! The methods under comparison, one folder each. They never import each other: what two need lives in `halfshade-scene`
//! or `halfshade-sh`; what neither can have, in `shared`.

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
