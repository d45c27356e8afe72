//! What an experiment comes down to: loaded scenes, and groups of runs that are measured together.

use crate::{
    Experiment, HarnessError, ReceiverKind, ReferenceKind, Variant, Weighting,
    experiment::{TimingSettings, View},
    file_names, inputs,
    reference::Accuracy,
    scene_source::{self, MeshLight},
    variant,
};
use glam::Vec3;
use halfshade_scene::{Camera, InputFile, Scene, input, scene::MAX_BOUNCES, spheres::MAX_SPHERES};
use halfshade_strategy::Strategy;
use std::{num::NonZeroUsize, path::PathBuf};
use toml::Spanned;

/// Samples that a noise target starts with.
const FIRST_SAMPLES: usize = 256;

/// `--quick` divides samples per receiver by this.
const QUICK_SAMPLES: usize = 8;

/// How much a difference between two strategies is magnified [Guerrero2007, figure 6.1].
pub const DIFFERENCE_FACTOR: f32 = 10.0;

/// What the picture of the truth is called.
pub const TRUTH_LABEL: &str = "truth";

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
        object.sphere_count = (own.saturating_mul(count) / total).saturating_sub(given).max(1);
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
    /// What vertices count by.
    pub weights: Weighting,
    /// Whether errors are told by class of what hides the light.
    pub classes: bool,
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
    /// The files that the scenes were read from, relative to the experiment.
    pub inputs: Vec<InputFile>,
}

impl Plan {
    /// Whether the variant at a place is compared with another one.
    pub fn is_compared(&self, place: usize) -> bool {
        self.pairs.iter().chain(&self.difference).flatten().any(|compared| *compared == place)
    }

    /// What the picture of the difference between the variants at two places is called.
    pub fn difference_label(&self, pair: [usize; 2]) -> String {
        let [a, b] = pair.map(|place| &self.variants[place].label);
        format!("{DIFFERENCE_FACTOR} times the difference: {a} and {b}")
    }

    /// Every file that a run may write, relative to its folder.
    pub fn outputs(&self) -> Vec<PathBuf> {
        let mut files = ["results.json", "results.csv", "report.md"].map(PathBuf::from).to_vec();
        let mut add = |base: String, endings: &[&str]| {
            files.extend(endings.iter().map(|ending| PathBuf::from(format!("{base}{ending}"))));
        };
        for (scene, frames) in &self.scenes {
            if self.timing.is_some() {
                for (frame, kind) in
                    frames.iter().flat_map(|frame| self.receivers.iter().map(move |kind| (*frame, kind)))
                {
                    add(file_names::plot(&scene.name, frame, &kind.to_string()), &[".svg", ".png"]);
                }
            }
            let Some(&first) = frames.first().filter(|_| !self.pictured.is_empty()) else { continue };
            let variants = self.variants.iter().filter(|variant| self.pictured.contains(&variant.key()));
            for variant in variants {
                add(file_names::picture(&scene.name, first, &variant.label), &[".exr", ".png", ".error.png"]);
            }
            let others = std::iter::once(TRUTH_LABEL.to_owned());
            for label in others.chain(self.difference.map(|pair| self.difference_label(pair))) {
                add(file_names::picture(&scene.name, first, &label), &[".exr", ".png"]);
            }
        }
        files
    }

    /// Whether any strategy or reference reads sphere sets.
    pub fn needs_spheres(&self, strategies: &[Box<dyn Strategy>]) -> bool {
        self.references.iter().any(|reference| *reference != ReferenceKind::Mesh)
            || self.variants.iter().any(|variant| strategies[variant.strategy].needs_spheres())
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
                let mut pictured: Vec<String> = Vec::new();
                for spec in specs {
                    let key = variants[place_of(spec)?].key();
                    if pictured.contains(&key) {
                        let problem = format!("`{}` is pictured already; name each once", spec.get_ref());
                        return Err(experiment.error_at(spec.span().start, problem));
                    }
                    pictured.push(key);
                }
                pictured
            }
        };
        let pair_of = |[a, b]: &[Spanned<String>; 2]| {
            let pair = [place_of(a)?, place_of(b)?];
            if pair[0] == pair[1] {
                return Err(experiment.error_at(a.span().start, "this compares a strategy with itself: name two"));
            }
            Ok(pair)
        };
        let difference = settings.and_then(|settings| settings.difference.as_ref()).map(pair_of).transpose()?;
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        for specs in &experiment.compare {
            let pair = pair_of(specs)?;
            if pairs.contains(&pair) {
                let problem = "`compare` has this pair already; name each once";
                return Err(experiment.error_at(specs[0].span().start, problem));
            }
            pairs.push(pair);
        }
        let folder = experiment.path.parent().unwrap_or(std::path::Path::new("."));
        let mut scenes: Vec<(Scene, Vec<usize>)> = Vec::new();
        let mut inputs = Vec::new();
        for entry in &experiment.scenes {
            let light = MeshLight { name: entry.environment.as_deref(), ..MeshLight::default() };
            let (scene, files) = input::recorded(|| scene_source::resolve(entry.name.get_ref(), folder, &light));
            inputs.extend(files);
            let mut scene = scene.map_err(|error| experiment.error_at(entry.name.span().start, error.to_string()))?;
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
                if scene.objects.iter().any(|object| object.sphere_count > MAX_SPHERES) {
                    let problem = format!("spheres = {count} gives an object more than the {MAX_SPHERES} it can use");
                    return Err(experiment.error_at(entry.name.span().start, problem));
                }
            }
            if scenes.iter().any(|(other, _)| other.name == scene.name) {
                let problem = format!(
                    "scene `{}` is listed twice: list it once, or give another `name` in its file to one of them",
                    scene.name
                );
                return Err(experiment.error_at(entry.name.span().start, problem));
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
        let others = experiment.references.iter().filter(|kind| **kind != ReferenceKind::Mesh);
        let references = std::iter::once(ReferenceKind::Mesh).chain(others.copied()).collect();
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
            weights: experiment.weights,
            classes: experiment.classes,
            details: experiment.details,
            pairs,
            variants,
            accuracy,
            timing,
            pictured,
            difference,
            resolution,
            inputs: inputs::relative_to(folder, inputs),
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
