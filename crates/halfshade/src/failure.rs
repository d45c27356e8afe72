//! Why a command ends before it has done what was asked.

use halfshade_harness::HarnessError;
use halfshade_scene::SceneError;

/// Why a command ended early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad usage or input.
    Error(String),
    /// Nobody reads the output any more.
    ClosedPipe,
}

impl From<HarnessError> for Failure {
    fn from(error: HarnessError) -> Self {
        Self::Error(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Error(error.to_string())
    }
}
