//! Arguments of comparisons without an experiment file: `compare`, and `tune`, which searches before it compares.

use super::{
    choices::{DeviceArgument, ReceiverChoice},
    count::sample_count,
};
use clap::Args;
use halfshade_harness::{ReceiverKind, experiment::Comparison};
use std::path::PathBuf;

/// Settings of comparisons without an experiment file.
#[derive(Debug, Args)]
pub struct ComparisonArguments {
    /// Light of mesh files: `sky`, `constant`, or an image (.hdr, .exr) [default: sky].
    #[arg(long, value_name = "LIGHT")]
    pub env: Option<String>,
    /// Frame of the animation.
    #[arg(long, default_value_t = 0)]
    pub frame: usize,
    /// Hold the scenes still at that frame, for methods that need one that doesn't move.
    #[arg(long)]
    pub still: bool,
    /// Score the pixels of the camera's picture, or the vertices.
    #[arg(long, value_enum, default_value_t = ReceiverChoice::Pixels)]
    pub receivers: ReceiverChoice,
    /// Samples of the truth per receiver.
    #[arg(long, default_value_t = 256, value_parser = sample_count)]
    pub samples: usize,
    /// Run on these devices: cpu, gpu, or a part of a graphics device's name [default: cpu].
    #[arg(long, value_name = "DEVICE", value_delimiter = ',')]
    pub device: Vec<DeviceArgument>,
}

impl ComparisonArguments {
    /// The comparison of `strategies` on `scenes`, with pictures and without a baseline.
    pub fn comparison(&self, purpose: &'static str, scenes: Vec<String>, strategies: Vec<String>) -> Comparison {
        Comparison {
            purpose,
            scenes,
            environment: self.env.clone(),
            strategies,
            baseline: None,
            frame: self.frame,
            still: self.still,
            receivers: match self.receivers {
                ReceiverChoice::Pixels => ReceiverKind::Pixels,
                ReceiverChoice::Vertices => ReceiverKind::Vertices,
            },
            samples: self.samples,
            pictures: true,
        }
    }
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Scene files, built-in names, or mesh files (which stand on a ground plane).
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// A strategy, as `name` or `name:key=value,key=value`; again for more [default: all, as they are by default].
    #[arg(long, value_name = "SPEC")]
    pub strategy: Vec<String>,
    /// The strategy that the verdict compares all others with [default: what errs least].
    #[arg(long, value_name = "SPEC")]
    pub baseline: Option<String>,
    /// How they are compared.
    #[command(flatten)]
    pub settings: ComparisonArguments,
    /// Draw no pictures.
    #[arg(long)]
    pub no_pictures: bool,
    /// Print the experiment file that would be run, and stop.
    #[arg(long)]
    pub print: bool,
    /// Where results go [default: out/compare-SCENE].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Fewer samples, three timed rounds: to see whether it works, not for publication.
    #[arg(long)]
    pub quick: bool,
    /// Go on with a run that was interrupted.
    #[arg(long)]
    pub resume: bool,
}

/// Arguments of `tune`.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("bound").required(true).multiple(true).args(["max_error", "frame_ms"]))]
pub struct TuneArguments {
    /// A scene file, a built-in name, or a mesh file (which stands on a ground plane).
    pub scene: String,
    /// Largest relative RMSE, such as 0.03: the fastest within it is searched.
    #[arg(long, value_name = "ERROR", value_parser = positive, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Longest frame in milliseconds; without --max-error the most exact within it is searched.
    #[arg(long, value_name = "MS", value_parser = positive, allow_negative_numbers = true)]
    pub frame_ms: Option<f64>,
    /// Search these strategies only.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Most memory of baked data in MiB.
    #[arg(long, value_name = "MIB", value_parser = positive, allow_negative_numbers = true)]
    pub memory_mb: Option<f64>,
    /// How they are compared.
    #[command(flatten)]
    pub settings: ComparisonArguments,
    /// Where results go [default: out/tune-SCENE].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".into())
}
