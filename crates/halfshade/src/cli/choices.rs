//! Values of arguments that several commands have: devices, kinds of receivers.

use clap::ValueEnum;
use halfshade_harness::Device;
use std::{convert::Infallible, str::FromStr};

/// A device, as users name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceArgument {
    /// The processor.
    Cpu,
    /// The graphics device that `--gpu` chooses.
    Gpu,
    /// The graphics device of this name.
    Named(String),
}

impl DeviceArgument {
    /// Its kind.
    pub fn device(&self) -> Device {
        match self {
            Self::Cpu => Device::Cpu,
            Self::Gpu | Self::Named(_) => Device::Gpu,
        }
    }

    /// The name of a graphics device.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Named(name) => Some(name),
            Self::Cpu | Self::Gpu => None,
        }
    }
}

impl FromStr for DeviceArgument {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "cpu" => Self::Cpu,
            "gpu" => Self::Gpu,
            name => Self::Named(name.to_owned()),
        })
    }
}

/// Which points are shaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReceiverChoice {
    /// One point per pixel.
    Pixels,
    /// Every vertex.
    Vertices,
}
