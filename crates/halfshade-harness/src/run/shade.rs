//! A variant baked, prepared and shaded once.

use super::{group::Group, setup::Setup};
use crate::{
    Variant,
    ability::inability,
    clock::time_secs,
    results::Status,
    shading::{count_not_finite, shade_frame},
};
use halfshade_scene::RadianceBuffer;
use halfshade_strategy::{Baked, StrategyError};

/// A baked strategy that has shaded, and its radiance.
pub(super) struct Shaded {
    pub(super) baked: Box<dyn Baked>,
    pub(super) radiance: RadianceBuffer,
}

/// Why a variant has no scores.
pub(super) struct Refusal {
    pub(super) status: Status,
    pub(super) reason: String,
    /// How many values are not finite.
    pub(super) not_finite: usize,
}

impl Refusal {
    fn failed(reason: String) -> Self {
        Self { status: Status::Failed, reason, not_finite: 0 }
    }

    fn unsupported(reason: String) -> Self {
        Self { status: Status::Unsupported, reason, not_finite: 0 }
    }
}

impl From<StrategyError> for Refusal {
    fn from(error: StrategyError) -> Self {
        match error {
            StrategyError::Unsupported(reason) => Self::unsupported(reason),
            StrategyError::Failed(reason) => Self::failed(reason),
        }
    }
}

const NO_KERNELS: &str = "no kernels for graphics devices yet: run it with device `cpu`";

/// Seconds of baking, and what a variant has shaded.
pub(super) fn shade_with(setup: &Setup<'_>, group: &Group<'_>, variant: &Variant) -> Result<(f64, Shaded), Refusal> {
    let (tools, frame) = (setup.tools, &group.frame);
    let strategy = tools.strategy(variant).ok_or_else(|| Refusal::unsupported(NO_KERNELS.into()))?;
    if let Some(reason) = inability(strategy, frame.scene, tools.strategies) {
        return Err(Refusal::unsupported(reason));
    }
    let (bake_secs, baked) = time_secs(tools.clock, || strategy.bake(frame.scene, &variant.params, tools.progress));
    let mut baked = baked?;
    let radiance = shade_frame(baked.as_mut(), frame, group.receivers.view())?;
    let broken = count_not_finite(&radiance);
    if broken > 0 {
        let reason = format!("{broken} of {} values are not finite", 3 * radiance.len());
        return Err(Refusal { not_finite: broken, ..Refusal::failed(reason) });
    }
    Ok((bake_secs, Shaded { baked, radiance }))
}
