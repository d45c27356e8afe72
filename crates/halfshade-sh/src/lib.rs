//! Spherical and zonal harmonics, Haar wavelets, cosine lobes: an f64 reference path beside batched f32 kernels.
//!
//! Mathematics only: no scene, no light, no renderer. Directions are `[x, y, z]` of unit length; the polar axis of the
//! basis is +z; `n` bands have `n²` coefficients, index `l(l+1) + m`, with the Condon-Shortley factor inside
//! [Guerrero2007, A].
//!
//! From a blocker to visibility:
//! - [`zonal`]: the blocker of an angular radius in closed form, and its rotation to an axis;
//! - [`logarithm`] and [`zonal_algebra`]: its logarithm in the truncated product algebra; [`blocker_table`] tabulates it;
//! - [`exponential`]: from a sum of logarithms back to visibility: series, optimal-linear ([`optimal_linear`]), hybrid;
//! - [`product`] and [`tripling`]: the SH product and its exact coefficients.
//!
//! ```
//! use halfshade_sh::{basis, zonal};
//! use std::f64::consts::PI;
//!
//! // Visibility beside a blocker of 60 degrees around +x, which covers a quarter of all directions.
//! let visibility = zonal::rotate_to_axis(&zonal::blocker(4, 0.5), [1.0, 0.0, 0.0]);
//! let visible = basis::dot(&visibility, &basis::one(4)) / (4.0 * PI);
//! assert!((visible - 0.75).abs() < 1e-12);
//! let [toward, away] = [1.0, -1.0].map(|x| basis::reconstruct(&visibility, [x, 0.0, 0.0]));
//! assert!(toward < 0.2 && away > 0.8);
//! ```
//!
//! From light: [`lat_long`] projects images, [`quadrature`] functions; [`rotation`] turns SH vectors; [`window`] tames
//! ringing, [`nonnegative`] as little as it must be; [`zh3`] keeps a third band about one axis. [`form_factor`] averages what a receiver sees of a sphere that shines.
//!
//! About a normal, [`hemisphere`] holds functions that matter on one side only.
//!
//! Beside harmonics, [`haar`] holds wavelets on the faces of a cube, for edges, and [`lobe`] cosine lobes: products,
//! integrals, lobes for caps.
//!
//! All that deals with harmonics is f64, for any number of bands, and plain; [`kernel`] holds its f32 twins for 1 to 8
//! bands, eight vectors side by side, tested against it.

pub mod basis;
pub mod blocker_table;
pub mod exponential;
pub mod form_factor;
pub mod haar;
pub mod hemisphere;
pub mod kernel;
pub mod lat_long;
pub mod lobe;
pub mod logarithm;
pub mod mean_normal;
pub mod nonnegative;
pub mod optimal_linear;
pub mod product;
pub mod quadrature;
mod recurrence;
pub mod rotation;
pub mod tripling;
pub mod wgsl;
pub mod window;
pub mod zh3;
pub mod zonal;
pub mod zonal_algebra;
