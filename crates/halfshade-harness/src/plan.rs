//! What an experiment comes down to: loaded scenes, and groups of runs that are measured together.

use crate::{
    Experiment, HarnessError, ReceiverKind, ReferenceKind, Variant,
    experiment::{TimingSettings, View},
    reference::Accuracy,
    scene_source, variant,
};
use glam::Vec3;
use halfshade_scene::{Camera, Scene, scene::MAX_BOUNCES};
use halfshade_strategy::Strategy;
use std::num::NonZeroUsize;
use toml::Spanned;

/// Samples that a noise target starts with.
const FIRST_SAMPLES: usize = 256;

/// `--quick` divides samples per receiver by this.
const QUICK_SAMPLES: usize = 8;

const BAD_VIEW: &str = "camera: eye and target must be finite and apart, vertical_fov_degrees between 0 and 180";

/// `camera` moved to `view`, or `None` if that can't be looked from.
fn viewed(view: &View, camera: &Camera) -> Option<Camera> {
    let (eye, target) = (Vec3::from(view.eye), Vec3::from(view.target));
    let fov = view.vertical_fov_degrees;
    let fits = eye.is_finite() && target.is_finite() && eye != target && fov > 0.0 && fov < 180.0;
    fits.then_some(Camera { eye, target, vertical_fov_degrees: fov, ..*camera })
}

/// Gives the scene's blockers `count` spheres in all, or one each if that is more, in proportion to what they have.
fn share_out_spheres(scene: &mut Scene, count: usize) {
    let total: usize = scene.objects.iter().map(|object| object.sphere_count).sum();
    let (mut own, mut given) = (0, 0);
    for object in scene.objects.iter_mut().filter(|object| object.sphere_count > 0) {
        // Rounded so that the sums are right, not each share.
        own += object.sphere_count;
        object.sphere_count = (own * count / total).saturating_sub(given).max(1);
        given += object.sphere_count;
    }
    scene.name = format!("{}, {count} spheres", scene.name);
}

/// All that is to be done.
#[derive(Debug)]
pub struct Plan {
    /// The scenes, without sphere sets, and the frames of each.
    pub scenes: Vec<(Scene, Vec<usize>)>,
    /// Kinds of receivers.
    pub receivers: Vec<ReceiverKind>,
    /// What runs are compared with; the mesh is the first.
    pub references: Vec<ReferenceKind>,
    /// Every strategy with its parameters.
    pub variants: Vec<Variant>,
    /// Whether strategies are asked for figures that only they have.
    pub details: bool,
    /// Places in `variants` of pairs that are compared with each other.
    pub pairs: Vec<[usize; 2]>,
    /// How exact the truth is.
    pub accuracy: Accuracy,
    /// How time is measured, if it is.
    pub timing: Option<TimingSettings>,
    /// Of which variants pictures are drawn, by [`Variant::key`]; nothing: of none.
    pub pictured: Vec<String>,
    /// Places in `variants` of two whose difference is drawn.
    pub difference: Option<[usize; 2]>,
    /// Size of pictures, if other than the camera's.
    pub resolution: Option<[u32; 2]>,
}

impl Plan {
    /// Whether the variant at a place is compared with another one.
    pub fn is_compared(&self, place: usize) -> bool {
        self.pairs.iter().chain(&self.difference).flatten().any(|compared| *compared == place)
    }

    /// Loads and checks everything, so that mistakes show before any work is done.
    pub fn new(experiment: &Experiment, strategies: &[Box<dyn Strategy>], quick: bool) -> Result<Self, HarnessError> {
        let variants = variant::sweep(experiment, strategies)?;
        let place_of = |spec: &Spanned<String>| {
            let error = |problem| experiment.error_at(spec.span().start, problem);
            let key = Variant::parse(strategies, spec.get_ref()).map_err(error)?.key();
            let unknown =
                || error(format!("`{}` is pictured or compared but not among the strategies", spec.get_ref()));
            variants.iter().position(|variant| variant.key() == key).ok_or_else(unknown)
        };
        let settings = experiment.pictures.as_ref();
        let pictured = match settings.map(|settings| &settings.strategies) {
            None => Vec::new(),
            Some(None) => variants.iter().map(Variant::key).collect(),
            Some(Some(specs)) => {
                specs.iter().map(|spec| Ok(variants[place_of(spec)?].key())).collect::<Result<_, HarnessError>>()?
            }
        };
        let difference = match settings.and_then(|settings| settings.difference.as_ref()) {
            Some([a, b]) => Some([place_of(a)?, place_of(b)?]),
            None => None,
        };
        let pairs = experiment.compare.iter().map(|[a, b]| Ok([place_of(a)?, place_of(b)?]));
        let pairs = pairs.collect::<Result<_, HarnessError>>()?;
        let folder = experiment.path.parent().unwrap_or(std::path::Path::new("."));
        let mut scenes: Vec<(Scene, Vec<usize>)> = Vec::new();
        for entry in &experiment.scenes {
            let mut scene = scene_source::resolve(entry.name.get_ref(), folder, entry.environment.as_deref())
                .map_err(|error| experiment.error_at(entry.name.span().start, error.to_string()))?;
            if let Some(light) = &entry.environment {
                let light = light.rsplit(['/', '\\']).next().unwrap_or(light);
                scene.name = format!("{}, {light}", scene.name);
            }
            if let Some(bounces) = &entry.bounces {
                scene.bounces = *bounces.get_ref();
                if scene.bounces > MAX_BOUNCES {
                    let problem = format!("bounces = {}: at most {MAX_BOUNCES}", scene.bounces);
                    return Err(experiment.error_at(bounces.span().start, problem));
                }
            }
            if let Some(view) = &entry.camera {
                scene.camera = viewed(view.get_ref(), &scene.camera)
                    .ok_or_else(|| experiment.error_at(view.span().start, BAD_VIEW))?;
            }
            if let Some(count) = entry.spheres {
                share_out_spheres(&mut scene, count.get());
            }
            if scenes.iter().any(|(other, _)| other.name == scene.name) {
                return Err(
                    experiment.error_at(entry.name.span().start, format!("scene `{}` is listed twice", scene.name))
                );
            }
            let mut frames = entry.frames.clone().unwrap_or_else(|| experiment.frames.clone());
            if let Some(past) = frames.iter().find(|frame| **frame >= scene.frame_count.max(1)) {
                let problem =
                    format!("scene `{}` has {} frames: there is no frame {past}", scene.name, scene.frame_count);
                return Err(experiment.error_at(entry.name.span().start, problem));
            }
            if quick {
                frames.truncate(1);
            }
            scenes.push((scene, frames));
        }
        // The mesh always comes first: it is the truth that everything is relative to.
        let mut references = vec![ReferenceKind::Mesh];
        for kind in &experiment.references {
            if !references.contains(kind) {
                references.push(*kind);
            }
        }
        let divisor = if quick { QUICK_SAMPLES } else { 1 };
        let samples = experiment.truth.samples.map_or(FIRST_SAMPLES, |samples| samples.get() as usize);
        let accuracy = Accuracy {
            samples: (samples / divisor).max(1),
            relative_noise: experiment.truth.relative_noise.filter(|_| !quick),
            seed: u64::from(experiment.truth.seed),
        };
        let timing = experiment.timing.map(|timing| match quick {
            true => TimingSettings {
                warm_up: 1,
                repeats: timing.repeats.min(std::num::NonZeroU32::MIN.saturating_add(2)),
                ..timing
            },
            false => timing,
        });
        let shrink = if quick { 2 } else { 1 };
        let resolution = experiment
            .pictures
            .as_ref()
            .and_then(|pictures| pictures.resolution)
            .map(|size| size.map(|n| (n.get() / shrink).max(1)));
        Ok(Self {
            scenes,
            receivers: experiment.receivers.clone(),
            references,
            details: experiment.details,
            pairs,
            variants,
            accuracy,
            timing,
            pictured,
            difference,
            resolution,
        })
    }

    /// The scene's camera, at the resolution of the experiment's pictures.
    pub fn camera(&self, scene: &Scene) -> Camera {
        Camera { resolution: self.resolution.unwrap_or(scene.camera.resolution), ..scene.camera }
    }

    /// The references that are needed besides the mesh, with each strategy's own bands spelled out.
    pub fn other_references(&self) -> Vec<ReferenceKind> {
        let mut kinds = Vec::new();
        for kind in &self.references[1..] {
            let concrete = match kind {
                ReferenceKind::OwnBands => self
                    .variants
                    .iter()
                    .filter_map(|v| NonZeroUsize::new(v.bands()?))
                    .map(ReferenceKind::Bands)
                    .collect(),
                other => vec![*other],
            };
            for kind in concrete {
                if !kinds.contains(&kind) {
                    kinds.push(kind);
                }
            }
        }
        kinds
    }

    /// Whether `variant` is compared with `kind`: with a number of bands only if it is its own.
    pub fn compares(&self, variant: &Variant, kind: ReferenceKind) -> bool {
        match kind {
            ReferenceKind::Bands(bands) => variant.bands() == Some(bands.get()),
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin;

    #[test]
    fn spheres_are_shared_out_as_they_were() {
        let counts = |scene: &Scene| -> Vec<usize> { scene.objects.iter().map(|object| object.sphere_count).collect() };
        let scene = builtin::scene("vases").unwrap();
        for (count, expected) in [(20, 20), (64, 64), (3, 5), (511, 511)] {
            let mut changed = scene.clone();
            share_out_spheres(&mut changed, count);
            assert_eq!(counts(&changed).iter().sum::<usize>(), expected, "{count}");
            let pairs = counts(&scene).into_iter().zip(counts(&changed));
            assert!(pairs.clone().all(|(before, after)| (before == 0) == (after == 0)), "{pairs:?}");
        }
        let mut same = scene.clone();
        share_out_spheres(&mut same, 20);
        assert_eq!((counts(&same), same.name.as_str()), (counts(&scene), "vases, 20 spheres"));
    }
}
