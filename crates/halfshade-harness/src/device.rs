//! Devices that strategies run on.

use halfshade_strategy::Strategy;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A kind of device, by the name that experiment files give it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Device {
    /// The processor.
    #[default]
    Cpu,
    /// The graphics device.
    Gpu,
}

impl Device {
    /// Whether it is the processor.
    pub fn is_cpu(&self) -> bool {
        *self == Self::Cpu
    }

    /// Its part of a key, behind the name of a strategy: nothing for the processor, as in keys that know no devices.
    pub(crate) fn key(self) -> String {
        if self.is_cpu() { String::new() } else { format!("@{self}") }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        })
    }
}

/// A graphics device, and the strategies that have kernels for it.
pub struct GraphicsDevice {
    /// Name and driver, and whether it is a program on the processor.
    pub description: String,
    /// The strategies, named as those of the processor.
    pub strategies: Vec<Box<dyn Strategy>>,
}

impl GraphicsDevice {
    /// The strategy of that name, if it has kernels.
    pub fn strategy(&self, name: &str) -> Option<&dyn Strategy> {
        self.strategies.iter().find(|strategy| strategy.info().name == name).map(Box::as_ref)
    }
}
