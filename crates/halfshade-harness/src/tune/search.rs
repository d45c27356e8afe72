//! The search: candidates from the cheapest on, without those of which a cheaper one has told enough.

use super::{
    Bounds,
    candidates::Candidate,
    trial::{Ground, Trial},
};
use crate::{
    HarnessError, ReceiverKind, ReceiverWeights, Reference, ReferenceKind,
    projection::Projection,
    reference::ReferenceTracer,
    run::{Plan, Tools},
};
use halfshade_scene::{Cache, RadianceBuffer, ReceiverBuffer, Scene};
use halfshade_truth::Tracer;
use std::sync::Arc;

/// Receivers at which the truth is traced.
const SAMPLE: usize = 2048;

/// Factor by which a time or an error of the search may be off.
const SLACK: f64 = 1.25;

/// A search on the first scene and frame of a plan.
pub(super) struct Search<'a> {
    pub(super) tools: &'a Tools<'a>,
    pub(super) plan: &'a Plan,
    pub(super) bounds: &'a Bounds,
}

/// Findings of a search.
pub(super) struct Tried {
    pub(super) trials: Vec<Trial>,
    /// Receivers at which errors were measured.
    pub(super) sample: usize,
    /// All receivers.
    pub(super) receivers: usize,
}

impl Search<'_> {
    pub(super) fn run(&self, candidates: Vec<Candidate>) -> Result<Tried, HarnessError> {
        let planned = &self.plan.scenes[0];
        let mut scene = planned.scene.clone();
        if self.plan.needs_spheres() {
            scene.build_spheres(self.tools.cache, self.tools.progress)?;
        }
        let (ground, sample) = self.ground(&scene, planned.frames[0], planned.receivers[0])?;
        let mut trials: Vec<Trial> = Vec::new();
        self.tools.progress.start("trying settings", candidates.len() as u64);
        for candidate in candidates {
            if !self.is_settled(&trials, &candidate) {
                trials.extend(ground.trial(self.tools, self.bounds, &candidate));
            }
            self.tools.progress.advance(1);
        }
        Ok(Tried { trials, sample, receivers: ground.receivers.len() })
    }

    /// Whether one that is no dearer tells that `candidate` is no choice.
    fn is_settled(&self, trials: &[Trial], candidate: &Candidate) -> bool {
        let bounds = self.bounds;
        let met = trials.iter().filter(|trial| bounds.are_met(&trial.figures));
        let best = met.map(|trial| trial.figures.frame_secs).fold(f64::INFINITY, f64::min);
        // Where the time is what is made small, whoever is slower than the best so far is out.
        let best = if bounds.error.is_some() { best } else { f64::INFINITY };
        let limit = SLACK * best.min(bounds.frame_secs.unwrap_or(f64::INFINITY));
        trials.iter().filter(|trial| trial.candidate.is_below(candidate)).any(|Trial { figures, .. }| {
            let exact_enough = bounds.error.is_some_and(|error| SLACK * figures.error <= error);
            exact_enough || figures.frame_secs > limit || bounds.bytes.is_some_and(|most| figures.bytes > most)
        })
    }

    /// The frame, its receivers, and the truth at a sample of them, whose number is returned.
    fn ground<'a>(
        &self,
        scene: &'a Scene,
        index: usize,
        kind: ReceiverKind,
    ) -> Result<(Ground<'a>, usize), HarnessError> {
        let frame = scene.frame(index);
        let receivers = match kind {
            ReceiverKind::Vertices => ReceiverBuffer::vertices(&frame),
            ReceiverKind::Pixels => Projection::of_pixels(&Tracer::new(&frame), &scene.camera).0,
        };
        let weights = ReceiverWeights::of_kind(kind, self.plan.weights, &frame, &receivers);
        if receivers.is_empty() {
            return Err(HarnessError::nothing_to_score(&scene.name, index, kind));
        }
        let places = spread(receivers.len());
        let sampled = ReceiverBuffer::gathered(receivers.view(), &places);
        let tracer = ReferenceTracer {
            accuracy: self.plan.accuracy,
            band_limit: self.tools.band_limit,
            cache: &Cache::disabled(),
            progress: self.tools.progress,
        };
        let scoring = (Arc::new(ReceiverWeights::equal(sampled.len())), Arc::default());
        let (reference, _) = tracer.trace(scene, index, sampled.view(), ReferenceKind::Mesh, scoring)?;
        let reference = scattered(&reference, &places, &weights)?;
        Ok((Ground { frame, receivers, reference }, places.len()))
    }
}

/// At most [`SAMPLE`] places among `count`, by steps of the golden section, which favour no row or column.
fn spread(count: usize) -> Vec<u32> {
    if count <= SAMPLE {
        return (0..count as u32).collect();
    }
    const STEP: f64 = 0.618_033_988_749_894_9;
    let mut places: Vec<u32> = (0..SAMPLE).map(|i| ((i as f64 * STEP).fract() * count as f64) as u32).collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// `reference` at `places` of as many receivers as there are `weights`; all others weigh nothing.
fn scattered(reference: &Reference, places: &[u32], weights: &ReceiverWeights) -> Result<Reference, HarnessError> {
    let count = weights.values().len();
    let mut is_sampled = vec![false; count];
    places.iter().for_each(|&place| is_sampled[place as usize] = true);
    let no_light = || HarnessError::input("the sampled receivers weigh nothing: score pixels instead");
    let weights = Arc::new(weights.only(|i| is_sampled[i]).ok_or_else(no_light)?);
    let scatter = |from: &RadianceBuffer| {
        let mut to = RadianceBuffer::zeros(count);
        for (channel, from) in to.channels.iter_mut().zip(&from.channels) {
            places.iter().zip(from).for_each(|(&place, &value)| channel[place as usize] = value);
        }
        to
    };
    Ok(Reference {
        standard_error: scatter(&reference.standard_error),
        ..Reference::exact(scatter(&reference.radiance), reference.unshadowed_mean, weights)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_spread_and_names_nobody_twice() {
        assert_eq!(spread(5), [0, 1, 2, 3, 4]);
        let places = spread(100_000);
        assert!(places.len() > SAMPLE - 10 && places.windows(2).all(|pair| pair[0] < pair[1]));
        let gaps = places.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(gaps.max().unwrap() < 3 * (100_000 / SAMPLE) as u32);
    }
}
