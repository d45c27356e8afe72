//! Invariants of every strategy under every kind of light: which number a receiver has, how strong light is
//! and in which unit lengths are, whether light comes from a lamp around everything or from afar, and who else is
//! there.

mod crowds;
mod far_away;
mod lamps_around;
mod numbers;
mod one_alone;
mod scales;
mod scenes;
