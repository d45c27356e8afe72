//! Spherical and zonal harmonics: an f64 reference path beside batched f32 kernels.

pub mod basis;
pub mod blocker_table;
pub mod exponential;
pub mod kernel;
pub mod logarithm;
pub mod optimal_linear;
pub mod product;
pub mod quadrature;
mod recurrence;
pub mod rotation;
pub mod tripling;
pub mod window;
pub mod zonal;
pub mod zonal_algebra;
