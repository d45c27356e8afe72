//! References: the truth, and truths of simpler scenes that tell where an error comes from.

use crate::{
    HarnessError, ReferenceKind, errors::Reference, reference_key::key, shading::count_not_finite,
    weights::ReceiverWeights,
};
use halfshade_scene::{Environment, Progress, RadianceBuffer, Receivers, Scene, cache::Cache};
use halfshade_truth::{Geometry, Hider, Options, Tracer, estimate};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Limits an environment to a number of bands of spherical harmonics. The harness knows no harmonics: its caller does.
pub type BandLimit<'a> = dyn Fn(&Environment, usize) -> Environment + Sync + 'a;

/// How exact references are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Samples per receiver, or where a noise target starts.
    pub samples: usize,
    /// Sample until the root mean square of the standard error is below this fraction of the unshadowed mean.
    pub relative_noise: Option<f64>,
    /// Seed of the samples.
    pub seed: u64,
}

/// A computed reference as the cache keeps it.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Stored {
    radiance: [Vec<f32>; 3],
    standard_error: [Vec<f32>; 3],
    draws: Vec<[Vec<f32>; 3]>,
    unshadowed: Vec<f32>,
    samples: usize,
}

impl Stored {
    /// Whether there is a value for each of so many receivers.
    fn is_of(&self, receiver_count: usize) -> bool {
        let channels = [&self.radiance, &self.standard_error].into_iter().chain(&self.draws).flatten();
        channels.chain([&self.unshadowed]).all(|values| values.len() == receiver_count)
    }
}

/// Traces references.
pub struct ReferenceTracer<'a> {
    /// How exact they are.
    pub accuracy: Accuracy,
    /// Limits an environment to some bands.
    pub band_limit: &'a BandLimit<'a>,
    /// Cache that keeps them.
    pub cache: &'a Cache,
    /// Receiver of progress.
    pub progress: &'a dyn Progress,
}

impl ReferenceTracer<'_> {
    /// Radiance of `receivers` at frame `index` of `scene` by the reference `kind`, and its samples per receiver.
    /// `kind` is not [`ReferenceKind::OwnBands`]: that one depends on who asks. Refuses light that is too bright or too dim
    /// for single precision.
    pub fn trace(
        &self,
        scene: &Scene,
        index: usize,
        receivers: Receivers<'_>,
        kind: ReferenceKind,
        (weights, hiders): (Arc<ReceiverWeights>, Arc<[Hider]>),
    ) -> Result<(Reference, usize), HarnessError> {
        let limited;
        let lit = match kind.bands() {
            Some(bands) => {
                limited = Scene { environment: (self.band_limit)(&scene.environment, bands.get()), ..scene.clone() };
                &limited
            }
            None => scene,
        };
        let geometry = if kind.has_spheres() { Geometry::Spheres(Default::default()) } else { Geometry::Mesh };
        let options = Options {
            geometry,
            samples: self.accuracy.samples,
            noise_target: self.accuracy.relative_noise,
            seed: self.accuracy.seed,
            bounces: scene.bounces,
            ..Options::default()
        };
        let frame = lit.frame(index);
        let key = key(&frame, receivers, &options);
        let (stored, _) = self.cache.get_or_compute(
            &key,
            |found: &Stored| found.is_of(receivers.len()),
            || {
                let estimate = estimate(&Tracer::new(&frame), receivers, &options, self.progress);
                Ok(Stored {
                    radiance: estimate.radiance.channels,
                    standard_error: estimate.standard_error.channels,
                    draws: estimate.draws.into_iter().map(|draw| draw.channels).collect(),
                    unshadowed: estimate.unshadowed,
                    samples: estimate.samples,
                })
            },
        )?;
        let buffer = |channels| RadianceBuffer { channels };
        let unshadowed_mean = weights.mean(|i| stored.unshadowed.get(i).map_or(0.0, |&mean| f64::from(mean)));
        let reference = Reference {
            standard_error: buffer(stored.standard_error),
            draws: stored.draws.into_iter().map(buffer).collect(),
            hiders,
            unshadowed: stored.unshadowed.into(),
            ..Reference::exact(buffer(stored.radiance), unshadowed_mean, weights)
        };
        let place = format!("scene `{}`, frame {index}, reference `{kind}`", scene.name);
        let values = [&reference.radiance, &reference.standard_error];
        check_range(values, &reference.draws, reference.unshadowed_mean, &place)?;
        Ok((reference, stored.samples))
    }
}

/// Refuses a truth that no error can be measured against: values that are not finite, or light so dim that single
/// precision cuts its digits off. `place` names scene and frame.
pub fn check_range(
    [radiance, standard_error]: [&RadianceBuffer; 2],
    draws: &[RadianceBuffer],
    unshadowed_mean: f64,
    place: &str,
) -> Result<(), HarnessError> {
    let buffers = [radiance, standard_error].into_iter().chain(draws);
    let broken = buffers.map(count_not_finite).max().unwrap_or(0);
    let count = 3 * radiance.len();
    if broken > 0 || !unshadowed_mean.is_finite() {
        return Err(HarnessError::input(format!(
            "{place}: {broken} of {count} values of the truth are not finite: the light is too bright for single precision; \
             make it dimmer, say at most 1e36"
        )));
    }
    let mean = unshadowed_mean.abs();
    if mean > 0.0 && mean < LEAST_RADIANCE {
        return Err(HarnessError::input(format!(
            "{place}: the mean of {count} unshadowed values of the truth is {mean:.1e}, too dim for single precision, which \
             cuts off digits below {LEAST_RADIANCE:.1e}; make the light brighter"
        )));
    }
    Ok(())
}

/// Mean radiance that keeps seven digits in single precision down to a ten-thousandth of it.
const LEAST_RADIANCE: f64 = 1e4 * f32::MIN_POSITIVE as f64;
