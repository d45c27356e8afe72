//! The plan of an experiment: loaded scenes, and groups of runs that are measured together.

use super::{
    choice::VariantChoice,
    scenes::{Loaded, PlannedScene, scenes},
    tools::RunOptions,
};
use crate::{
    Device, Experiment, HarnessError, Part, ReceiverKind, ReferenceKind, Variant, Weighting,
    experiment::TimingSettings, file_names, reference::Accuracy, report::LEAST_FRAMES, stability::StabilityFigures,
    variant,
};
use halfshade_scene::InputFile;
use halfshade_strategy::Strategy;
use std::{
    num::{NonZeroU32, NonZeroUsize},
    ops::Range,
    path::PathBuf,
};

/// Samples that a noise target starts with.
const FIRST_SAMPLES: usize = 256;

/// `--quick` divides samples per receiver by this.
const QUICK_SAMPLES: usize = 8;

/// How much a difference between two strategies is magnified [Guerrero2007, figure 6.1].
pub(super) const DIFFERENCE_FACTOR: f32 = 10.0;

/// Label of the truth's picture.
pub(super) const TRUTH_LABEL: &str = "truth";

/// All that is to be done.
#[derive(Debug)]
pub struct Plan {
    /// The scenes.
    pub scenes: Vec<PlannedScene>,
    /// References of the runs; the mesh is the first.
    pub references: Vec<ReferenceKind>,
    /// Every strategy with its parameters.
    pub variants: Vec<Variant>,
    /// Weights of vertices.
    pub weights: Weighting,
    /// Whether errors are told by class of what hides the light.
    pub classes: bool,
    /// Whether strategies are asked for figures that only they have.
    pub details: bool,
    /// Bounds on how strategies behave, if they are to be told.
    pub stability: Option<StabilityFigures>,
    /// Whether errors are taken apart by stages.
    pub stages: bool,
    /// Places in `variants` of pairs that are compared with each other.
    pub pairs: Vec<[usize; 2]>,
    /// Place in `variants` of the one that all others are compared with in verdicts.
    pub baseline: Option<usize>,
    /// How exact the truth is.
    pub accuracy: Accuracy,
    /// How time is measured, if it is.
    pub timing: Option<TimingSettings>,
    /// Variants whose pictures are drawn, by [`Variant::key`].
    pub pictured: Vec<String>,
    /// Places in `variants` of two whose difference is drawn.
    pub difference: Option<[usize; 2]>,
    /// The files that the scenes were read from, relative to the experiment.
    pub inputs: Vec<InputFile>,
    /// Devices, in the order of the variants.
    pub devices: Vec<Device>,
    /// The part of it that is carried out.
    pub part: Part,
}

/// Runs of one frame of a scene on one kind of receivers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PlannedGroup {
    /// Place of the scene.
    pub(super) scene: usize,
    pub(super) frame: usize,
    pub(super) kind: ReceiverKind,
    /// Whether pictures are drawn of it: of the first of each scene.
    pub(super) pictured: bool,
    /// Places of the variants that are run in this part.
    pub(super) own: Range<usize>,
}

impl Plan {
    /// Whether anything runs on a graphics device.
    pub fn uses_graphics(&self) -> bool {
        self.variants.iter().any(|variant| !variant.device.is_cpu())
    }

    /// Whether the variant at a place is compared with another one.
    pub fn is_compared(&self, place: usize) -> bool {
        self.pairs.iter().chain(&self.difference).flatten().any(|compared| *compared == place)
    }

    /// Label of the picture of the difference between the variants at two places.
    pub fn difference_label(&self, pair: [usize; 2]) -> String {
        let [a, b] = pair.map(|place| &self.variants[place].label);
        format!("{DIFFERENCE_FACTOR} times the difference: {a} and {b}")
    }

    /// Every file that a run may write, relative to its folder.
    pub fn outputs(&self) -> Vec<PathBuf> {
        let mut files = ["results.json", "results.csv", "report.md", "report.html"].map(PathBuf::from).to_vec();
        let mut add = |base: String, endings: &[&str]| {
            files.extend(endings.iter().map(|ending| PathBuf::from(format!("{base}{ending}"))));
        };
        for PlannedScene { scene, frames, receivers, .. } in &self.scenes {
            for (frame, kind) in frames.iter().flat_map(|frame| receivers.iter().map(move |kind| (*frame, kind))) {
                if self.timing.is_some() {
                    add(file_names::plot(&scene.name, frame, &kind.to_string()), &[".svg", ".png"]);
                }
                if self.stages {
                    add(file_names::plot_of_stages(&scene.name, frame, &kind.to_string()), &[".svg", ".png"]);
                }
            }
            if frames.len() >= LEAST_FRAMES {
                for kind in receivers {
                    add(file_names::plot_over_frames(&scene.name, &kind.to_string()), &[".svg", ".png"]);
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

    /// The groups in which this part has anything to do, in the order of the results.
    pub(super) fn groups(&self) -> Vec<PlannedGroup> {
        let of_scene = |(place, scene): (usize, &PlannedScene)| {
            let all = scene.frames.iter().flat_map(|&frame| scene.receivers.iter().map(move |&kind| (frame, kind)));
            all.enumerate().map(move |(number, (frame, kind))| (place, frame, kind, number == 0)).collect::<Vec<_>>()
        };
        let all: Vec<_> = self.scenes.iter().enumerate().flat_map(of_scene).collect();
        let each = self.variants.len();
        let own = self.part.range(all.len() * each);
        let group = |(number, (scene, frame, kind, pictured)): (usize, (usize, usize, ReceiverKind, bool))| {
            let within = |run: usize| run.clamp(number * each, (number + 1) * each) - number * each;
            PlannedGroup { scene, frame, kind, pictured, own: within(own.start)..within(own.end) }
        };
        let groups = all.into_iter().enumerate().map(group);
        groups.filter(|group| !group.own.is_empty()).collect()
    }

    /// Leaves out what `part` leaves to others. Who only measures time shades to no end: a sample will do as the truth.
    fn of_part(mut self, part: Part, experiment: &Experiment) -> Result<Self, HarnessError> {
        if part == Part::Times && self.timing.is_none() {
            let problem = "has no `[timing]`: there are no times to measure";
            return Err(HarnessError::in_file(&experiment.path, problem));
        }
        self.timing = self.timing.filter(|_| part.has_times());
        if !part.has_errors() {
            self.accuracy = Accuracy { samples: 1, relative_noise: None, ..self.accuracy };
            self.references = vec![ReferenceKind::Mesh];
            (self.classes, self.details, self.stages) = (false, false, false);
            (self.pairs, self.pictured, self.difference) = (Vec::new(), Vec::new(), None);
        }
        Ok(Self { part, ..self })
    }

    /// Whether any strategy or reference reads sphere sets.
    pub fn needs_spheres(&self) -> bool {
        self.other_references().iter().any(|kind| kind.has_spheres())
            || self.variants.iter().any(|variant| variant.needs_spheres)
    }

    /// Loads and checks everything, so that mistakes show before any work is done.
    pub fn new(
        experiment: &Experiment,
        strategies: &[Box<dyn Strategy>],
        options: &RunOptions,
    ) -> Result<Self, HarnessError> {
        let quick = options.quick;
        let devices = options.devices.as_ref().unwrap_or(&experiment.devices);
        let swept = variant::sweep(experiment, strategies)?;
        let variants: Vec<Variant> =
            swept.iter().flat_map(|variant| devices.iter().map(|&device| variant.on(device))).collect();
        let choice = VariantChoice { experiment, strategies, devices, variants: &variants };
        let (pictured, difference, pairs) = (choice.pictured()?, choice.difference()?, choice.pairs()?);
        let baseline = choice.baseline()?;
        let Loaded { scenes, inputs } = scenes(experiment, quick)?;
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
            true => {
                TimingSettings { warm_up: 1, repeats: timing.repeats.min(NonZeroU32::MIN.saturating_add(2)), ..timing }
            }
            false => timing,
        });
        let plan = Self {
            scenes,
            references,
            weights: experiment.weights,
            classes: experiment.classes,
            details: experiment.details,
            stability: experiment.stability.as_ref().map(|bounds| *bounds.get_ref()),
            stages: experiment.stages,
            pairs,
            baseline,
            variants,
            accuracy,
            timing,
            pictured,
            difference,
            inputs,
            devices: devices.clone(),
            part: Part::Whole,
        };
        plan.of_part(options.part, experiment)
    }

    /// The references that are needed besides the mesh, with each strategy's own bands spelled out.
    pub fn other_references(&self) -> Vec<ReferenceKind> {
        let mut kinds = Vec::new();
        let own: Vec<ReferenceKind> = self.variants.iter().filter_map(own_bands).collect();
        for kind in &self.references[1..] {
            let of_bands: Vec<ReferenceKind> = match kind {
                ReferenceKind::OwnBands => own.clone(),
                _ => own.iter().copied().filter(|own| own.bands() == kind.bands()).collect(),
            };
            // Without a strategy of those bands it still tells what they leave of the truth.
            let concrete = if of_bands.is_empty() && *kind != ReferenceKind::OwnBands { vec![*kind] } else { of_bands };
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
        kind.bands().is_none() || own_bands(variant) == Some(kind)
    }
}

/// The truth under light of as many bands as a variant has, with spheres if it knows of these alone.
fn own_bands(variant: &Variant) -> Option<ReferenceKind> {
    let bands = NonZeroUsize::new(variant.bands()?)?;
    Some(if variant.needs_spheres { ReferenceKind::Bands(bands) } else { ReferenceKind::MeshBands(bands) })
}
