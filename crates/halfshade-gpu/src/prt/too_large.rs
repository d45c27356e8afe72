//! Tables that the device can't hold.

use crate::GpuError;
use halfshade_strategy::StrategyError;

/// An error, told with what to take instead if vectors are larger than the device can bind.
pub(super) fn told(error: GpuError) -> StrategyError {
    match error {
        GpuError::TooLarge { bytes, limit, .. } => StrategyError::Unsupported(format!(
            "transfer vectors take {bytes} bytes, but the graphics device binds {limit} at most; take fewer bands or components, or device `cpu`"
        )),
        error => error.into(),
    }
}
