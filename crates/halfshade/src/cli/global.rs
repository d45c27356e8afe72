//! Arguments of every command.

use super::count::thread_count;
use clap::Args;
use std::path::PathBuf;

/// Arguments of every command.
#[derive(Debug, Args)]
pub struct GlobalArguments {
    /// Keep baked data in this folder instead of the platform's cache (or set HALFSHADE_CACHE).
    #[arg(long, global = true, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Use this many threads instead of all.
    #[arg(long, global = true, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Graphics device to use where one is asked for: auto, off, a number or a part of its name (or set HALFSHADE_GPU)
    /// [default: auto].
    #[arg(long, global = true, value_name = "CHOICE")]
    pub gpu: Option<halfshade_gpu::Choice>,
    /// Tell errors only: no notes, no progress.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Tell each stage as it begins.
    #[arg(short, long, global = true)]
    pub verbose: bool,
}
