//! The plan of an experiment: loaded scenes, and groups of runs that are measured together.

use super::{
    choice::VariantChoice,
    scenes::{Loaded, PlannedScene, scenes},
    tools::RunOptions,
};
use crate::{
    Experiment, HarnessError, ReferenceKind, Variant, Weighting, experiment::TimingSettings, file_names,
    reference::Accuracy, report::LEAST_FRAMES, stability::StabilityFigures, variant,
};
use halfshade_scene::InputFile;
use halfshade_strategy::Strategy;
use std::{
    num::{NonZeroU32, NonZeroUsize},
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
        for PlannedScene { scene, frames, receivers } in &self.scenes {
            if self.timing.is_some() {
                for (frame, kind) in frames.iter().flat_map(|frame| receivers.iter().map(move |kind| (*frame, kind))) {
                    add(file_names::plot(&scene.name, frame, &kind.to_string()), &[".svg", ".png"]);
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

    /// Whether any strategy or reference reads sphere sets.
    pub fn needs_spheres(&self, strategies: &[Box<dyn Strategy>]) -> bool {
        self.references.iter().any(|reference| *reference != ReferenceKind::Mesh)
            || self.variants.iter().any(|variant| strategies[variant.strategy].needs_spheres())
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
        Ok(Self {
            scenes,
            references,
            weights: experiment.weights,
            classes: experiment.classes,
            details: experiment.details,
            stability: experiment.stability.as_ref().map(|bounds| *bounds.get_ref()),
            pairs,
            baseline,
            variants,
            accuracy,
            timing,
            pictured,
            difference,
            inputs,
        })
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
