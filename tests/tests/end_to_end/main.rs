//! The command from end to end, as one program: linking is slow, and its tests needn't wait for each other.

mod bad_input;
mod browser;
mod command_line;
mod common;
mod exchange;
mod experiments;
mod guide;
mod pages;
mod readme;
mod references;
mod runs;
mod shared_assets;
mod spheres_where_needed;
mod sweeps;
