//! Tests that several methods pass alike.

mod channels;
mod deformation;
mod ground_scale;
mod invariants;
