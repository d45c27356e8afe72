//! SH exponentiation.

mod reflections;
mod stability;
