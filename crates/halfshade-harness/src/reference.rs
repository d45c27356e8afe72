//! References: the truth, and truths of simpler scenes that tell where an error comes from.

use crate::{HarnessError, ReferenceKind, metrics::Reference};
use halfshade_scene::{
    Environment, Frame, Progress, RadianceBuffer, Receivers, Scene,
    cache::{Cache, CacheKey},
    light::DistantLight,
};
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

/// Raise it whenever the meaning of what is cached changes.
const VERSION: u32 = 3;

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

/// Everything the truth depends on, by its exact bits.
fn key(frame: &Frame<'_>, receivers: Receivers<'_>, options: &Options) -> CacheKey {
    let mut key = CacheKey::new("truth", VERSION)
        .value(&(&receivers.position, &receivers.normal, &receivers.albedo, receivers.index))
        .value(&(options.samples, options.noise_target, options.max_samples, options.seed, options.bounces))
        .bytes(format!("{:?} {:?}", options.geometry, options.transport).as_bytes())
        .value(&frame.world_from_environment);
    for (number, pose) in frame.world_from_object.iter().enumerate() {
        let object = &frame.scene.objects[number];
        key = key.value(&(frame.positions(number), &object.mesh.triangles)).value(&(
            pose.scale,
            pose.rotation,
            pose.translation,
        ));
        if frame.deformed(number).is_some() {
            // How the spheres below have followed depends on the rest as well.
            key = key.value(&object.mesh.positions);
        }
        for sphere in object.spheres.iter().flat_map(|set| &set.spheres) {
            key = key.value(&(sphere.center, sphere.radius));
        }
    }
    if frame.scene.is_glossy() {
        let eye = frame.scene.camera.eye;
        key = key.value(&(eye, receivers.object, receivers.specular_factor, receivers.exponent_factor));
        for object in &frame.scene.objects {
            key = key.bytes(format!("{:?}", object.material.reflectance).as_bytes());
            if options.bounces > 0 {
                key = key.bytes(format!("{:?}", object.material.gloss_variation).as_bytes());
            }
        }
    }
    if options.bounces > 0 {
        for (number, object) in frame.scene.objects.iter().enumerate() {
            let mesh = &object.mesh;
            key = key.value(&(object.material.albedo, frame.normals(number), &mesh.colors, &mesh.texture_coordinates));
            key = key.value(&object.material.texture.is_some());
            for texture in mesh.textures.iter().chain(&object.material.texture) {
                key = key.value(&**texture);
            }
        }
    }
    let environment = &frame.scene.environment;
    key = match &environment.base {
        DistantLight::Constant(radiance) => key.value(radiance),
        DistantLight::Map(map) => key.value(&(map.width(), map.height(), map.texels())),
    };
    key = key.value(&environment.sun.map(|sun| (sun.direction, sun.angular_radius, sun.radiance)));
    for light in &frame.lights {
        key = key.value(&(light.center, light.radius, light.radiance));
    }
    key
}
