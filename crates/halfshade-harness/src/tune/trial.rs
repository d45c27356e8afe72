//! One candidate tried: baked, shaded, compared at the sample, and timed for a frame or three.

use super::{Bounds, bounds::Figures, candidates::Candidate};
use crate::{
    Reference,
    frame_time::{neighbour, timed_frame},
    metrics::compare,
    run::Tools,
    shading::{count_not_finite, shade_frame},
    statistics::median,
};
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer};
use halfshade_strategy::{Effects, StrategyError};

/// How many times a bound a first frame may take, or a first error be, and still be timed again.
const FAR: f64 = 2.0;

/// A candidate with what was found.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// The candidate.
    pub(super) candidate: Candidate,
    /// What was found.
    pub(super) figures: Figures,
}

/// What candidates are tried on.
pub(super) struct Ground<'a> {
    pub(super) frame: Frame<'a>,
    pub(super) receivers: ReceiverBuffer,
    /// The truth at a sample; all other receivers weigh nothing.
    pub(super) reference: Reference,
}

impl Ground<'_> {
    /// Tries a candidate; `None` if it can't model the scene, fails, or there is no light to compare with.
    pub(super) fn trial(&self, tools: &Tools<'_>, bounds: &Bounds, candidate: &Candidate) -> Option<Trial> {
        let figures = self.figures(tools, bounds, candidate).ok().flatten()?;
        Some(Trial { candidate: candidate.clone(), figures })
    }

    fn figures(
        &self,
        tools: &Tools<'_>,
        bounds: &Bounds,
        candidate: &Candidate,
    ) -> Result<Option<Figures>, StrategyError> {
        let Some(strategy) = tools.strategy(&candidate.variant) else { return Ok(None) };
        if !strategy.info().effects.missing(Effects::required_by(self.frame.scene)).is_empty() {
            return Ok(None);
        }
        let mut baked = strategy.bake(self.frame.scene, &candidate.variant.params, tools.progress)?;
        let radiance = shade_frame(baked.as_mut(), &self.frame, self.receivers.view())?;
        if count_not_finite(&radiance) > 0 {
            return Ok(None);
        }
        let Some(error) = compare(&radiance, &self.reference).and_then(|metrics| metrics.rel_rmse) else {
            return Ok(None);
        };
        let bytes = baked.footprint().bytes() as f64;
        let neighbour = neighbour(&self.frame);
        let mut out = RadianceBuffer::zeros(self.receivers.len());
        let mut rounds = Vec::new();
        let mut figures = Figures { error, frame_secs: 0.0, bytes };
        // The first round wakes what sleeps; of one that is far from any choice no more is asked.
        while rounds.len() < 3 && (rounds.len() < 2 || bounds.strain(&figures) < FAR) {
            let frames = [&neighbour, &self.frame];
            let device = candidate.variant.device;
            let sample = timed_frame(tools.clock, device, baked.as_mut(), frames, &self.receivers, &mut out)?;
            rounds.push(sample.prepare_secs + sample.shade_secs);
            figures.frame_secs = median(&rounds[rounds.len().min(2) - 1..]).unwrap_or_default();
        }
        Ok((figures.error.is_finite() && figures.frame_secs > 0.0).then_some(figures))
    }
}
