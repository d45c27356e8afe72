//! References: the truth, and truths of simpler scenes that tell where an error comes from.

use crate::{HarnessError, ReferenceKind, metrics::Reference, reference_key::key};
use halfshade_scene::{Environment, Progress, RadianceBuffer, Receivers, Scene, cache::Cache};
use halfshade_truth::{Geometry, Options, Tracer, estimate};
use serde::{Deserialize, Serialize};

/// Limits an environment to a number of bands of spherical harmonics. The harness knows no harmonics: its caller does.
pub type BandLimit<'a> = dyn Fn(&Environment, usize) -> Environment + Sync + 'a;

/// How exact references are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Samples per receiver, or where a noise target starts.
    pub samples: usize,
    /// Sample until the root mean square of the standard error is below this fraction of the unshadowed mean.
    pub relative_noise: Option<f64>,
    /// Where the samples start from.
    pub seed: u64,
}

/// What was computed for one reference; what is kept in the cache.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Stored {
    radiance: [Vec<f32>; 3],
    standard_error: [Vec<f32>; 3],
    samples: usize,
    unshadowed_mean: f64,
}

/// What traces references.
pub struct ReferenceTracer<'a> {
    /// How exact they are.
    pub accuracy: Accuracy,
    /// Limits an environment to some bands.
    pub band_limit: &'a BandLimit<'a>,
    /// Where they are kept.
    pub cache: &'a Cache,
    /// Who is told how far it is.
    pub progress: &'a dyn Progress,
}

impl ReferenceTracer<'_> {
    /// Radiance of `receivers` at frame `index` of `scene` by the reference `kind`, and its samples per receiver.
    /// `kind` is not [`ReferenceKind::OwnBands`]: that one depends on who asks.
    pub fn trace(
        &self,
        scene: &Scene,
        index: usize,
        receivers: Receivers<'_>,
        kind: ReferenceKind,
    ) -> Result<(Reference, usize), HarnessError> {
        let limited;
        let lit = match kind {
            ReferenceKind::Bands(bands) => {
                limited = Scene { environment: (self.band_limit)(&scene.environment, bands.get()), ..scene.clone() };
                &limited
            }
            _ => scene,
        };
        let geometry = match kind {
            ReferenceKind::Mesh => Geometry::Mesh,
            _ => Geometry::Spheres(Default::default()),
        };
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
        let (stored, _) = self.cache.get_or_compute(&key, || {
            let estimate = estimate(&Tracer::new(&frame), receivers, &options, self.progress);
            Ok(Stored {
                radiance: estimate.radiance.channels,
                standard_error: estimate.standard_error.channels,
                samples: estimate.samples,
                unshadowed_mean: estimate.unshadowed_mean,
            })
        })?;
        let reference = Reference {
            radiance: RadianceBuffer { channels: stored.radiance },
            standard_error: RadianceBuffer { channels: stored.standard_error },
            unshadowed_mean: stored.unshadowed_mean,
        };
        Ok((reference, stored.samples))
    }
}
