//! Ray tracing.

mod cutouts;
