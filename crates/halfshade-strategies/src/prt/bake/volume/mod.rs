//! An irradiance volume [Greger1998] with transfer: what light from infinitely far becomes at points of a grid in a scene that stands
//! still, for receivers that move through it.
//!
//! ```text
//! M_ij(p) = ∫ y_i(ω) (V(p, ω) y_j(ω) + (1 - V(p, ω)) albedo(h) T_j(h)) dω
//! ```
//!
//! with h what is met along ω and T its transfer with one bounce less than the scene asks for: M times the light's vector is the
//! vector of the light that arrives at p. The integral is a sum over directions in equal shares of the sphere, as the identity
//! less what is hidden, so that a point that sees everything is exact.
//!
//! A body that keeps its shape has transfer of its own, in its own space (`own`): what it hides from itself is baked, and turns with it.
//! Bodies that deform, and all where transfer is unshadowed, have the cosine about their normals.
//!
//! **Where it errs.** Bodies that move hide nothing from each other or from what stands still, and reflect nothing. Between points all
//! is linear, so that light leaks through walls that are thinner than a step. Points within solids know no light: they take the
//! mean of their neighbours outside, step by step inwards.

mod bounds;
mod light;
mod own;
mod probes;

pub(crate) use bounds::of_movers;
pub(crate) use light::Volume;
pub(crate) use own::of_bodies;
pub(crate) use probes::Probes;
