//! The methods under comparison, one folder each. They never import each other: what two need lives in `halfshade-scene`
//! or `halfshade-sh`.

pub mod ray_traced;
#[cfg(test)]
mod test_scenes;
pub mod unshadowed;

pub use ray_traced::RayTraced;
pub use unshadowed::Unshadowed;
