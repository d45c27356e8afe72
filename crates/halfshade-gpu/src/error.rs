//! Errors of graphics hardware.

use halfshade_strategy::StrategyError;

/// Why something could not be done on a graphics device.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// There is no device at all.
    #[error(
        "no graphics device: {0}. Install the vendor's Vulkan driver; for one in software, `apt-get install \
         mesa-vulkan-drivers libvulkan1`"
    )]
    NoAdapter(String),
    /// There is none of that name or number.
    #[error("no graphics device `{asked}`; there are: {known}")]
    UnknownAdapter {
        /// The wish.
        asked: String,
        /// All that there are, with numbers.
        known: String,
    },
    /// The driver gave up.
    #[error("the graphics device was lost ({0}); run again, with fewer receivers if it happens again")]
    Lost(String),
    /// Memory on the device is full.
    #[error(
        "out of memory on the graphics device while it held {held} bytes of ours: {problem}; use fewer receivers or a smaller table"
    )]
    OutOfMemory {
        /// Bytes of our buffers.
        held: u64,
        /// In the driver's words.
        problem: String,
    },
    /// Something is larger than the device allows.
    #[error("{what} take {bytes} bytes, but the graphics device binds {limit} at most")]
    TooLarge {
        /// The buffer.
        what: String,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// It doesn't answer.
    #[error("the graphics device did not finish within {0} s")]
    Timeout(u64),
    /// Anything else, which should not happen.
    #[error("the graphics device refused: {0}")]
    Refused(String),
}

impl From<GpuError> for StrategyError {
    fn from(error: GpuError) -> Self {
        Self::Failed(error.to_string())
    }
}
