//! Cosine lobes.

mod environment;
mod lamps;
