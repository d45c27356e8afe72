//! Ray tracing.

mod cutouts;
mod few_rays;
