//! The methods under comparison, one folder each. They never import each other: what two need lives in `halfshade-scene`
//! or `halfshade-sh`.

pub mod ray_traced;
pub mod sh_exp;
#[cfg(test)]
mod test_scenes;
pub mod unshadowed;

pub use ray_traced::RayTraced;
pub use sh_exp::ShExp;
pub use unshadowed::Unshadowed;
