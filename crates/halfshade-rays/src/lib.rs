//! Rays against triangles, for whoever asks what hides what: strategies, baking, and the truth that judges them.
//!
//! A mesh has a hierarchy of its own ([`MeshRays`]), which is built once and refitted when the mesh deforms; a frame puts one over
//! the meshes where they stand ([`SceneRays`]). Rays ask for any triangle on their way, or for the closest one:
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use halfshade_rays::{MeshRays, Ray};
//!
//! let mesh = MeshRays::new(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]]);
//! let ray = Ray::new(DVec3::new(0.25, 0.25, -2.0), DVec3::Z);
//! assert!(mesh.any(&ray, |_| true) && !mesh.any(&ray.until(1.5), |_| true));
//! let crossing = mesh.closest(&ray, |_| true).expect("the triangle is in the way");
//! assert_eq!((crossing.distance, crossing.weights()), (2.0, DVec3::new(0.5, 0.25, 0.25)));
//! ```
//!
//! - **Boxes** are met eight at a time, with the vector units of x86-64-v3, in single precision, and are larger than what they hold by
//!   all that rounding may do.
//! - **Triangles** too: single precision leaves out those that a ray passes for sure. What is left, one or two, is decided in double
//!   precision by a watertight test, so that no answer depends on the hierarchy.
//! - **Starts on surfaces** ([`Ray::leaving`]) neither meet the surface that they leave nor fall through what touches it, though their
//!   coordinates were rounded.
//! - **Any size and place**: a mesh is traced in a space of its own, about its middle, where it has half extents near 1.

pub mod binary;
mod block;
mod mesh_rays;
mod ray;
mod scene_rays;
mod space;
mod triangle;
mod wide_hierarchy;

pub use mesh_rays::MeshRays;
pub use ray::Ray;
pub use scene_rays::{Instance, SceneRays};
pub use space::origin_between;
pub use triangle::Crossing;
