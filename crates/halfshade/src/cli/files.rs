//! Arguments of commands about files that people write.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Kinds of files that people write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FileChoice {
    /// A scene: meshes, light, a camera.
    Scene,
    /// An experiment: scenes, strategies, how exactly they are compared.
    Experiment,
}

/// Arguments of `new`.
#[derive(Debug, Args)]
pub struct NewArguments {
    /// Kind of the file.
    #[arg(value_enum)]
    pub kind: FileChoice,
    /// The file, which must not be there yet [default: scene.toml or experiment.toml].
    pub file: Option<PathBuf>,
}

/// Arguments of `schema`.
#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Kind of the files.
    #[arg(value_enum)]
    pub kind: FileChoice,
    /// Print tables in Markdown.
    #[arg(long)]
    pub markdown: bool,
}
