//! Running an experiment: bake, prepare, shade, score, time, picture; journal every step.

use crate::{
    Clock, Experiment, HarnessError, Picture, ReceiverKind, ReceiverWeights, Reference, ReferenceKind, Results,
    Variant, Weighting,
    classes::by_class,
    clock::time_secs,
    file_names,
    image_io::{exr_bytes, png_bytes},
    image_metrics::Similarity,
    inputs,
    journal::{self, Entry, Header, Journal},
    machine,
    metrics::{Metrics, compare, mean},
    out_folder::OutFolder,
    picture_colors::signed_error,
    plan::{DIFFERENCE_FACTOR, Plan, TRUTH_LABEL},
    projection::Projection,
    reference::{BandLimit, ReferenceTracer},
    results::{
        Detail, Difference, ErrorFigures, Memory, PictureFiles, Run, SCHEMA, Sample, SceneFacts, Status, TimeFigures,
        TruthFigures,
    },
    resume::{Beginning, Known},
    shading::{count_not_finite, shade_all},
    ssim::WINDOW,
    threads,
};
use glam::Vec3;
use halfshade_scene::{Frame, InputFile, Progress, RadianceBuffer, ReceiverBuffer, Scene, cache::Cache};
use halfshade_strategy::{Baked, Effects, Strategy, StrategyError};
use halfshade_truth::{Hider, Tracer, hiders};
use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

/// What the harness is given: it names no strategy and owns no terminal.
pub struct Tools<'a> {
    /// All strategies.
    pub strategies: &'a [Box<dyn Strategy>],
    /// Limits an environment to some bands.
    pub band_limit: &'a BandLimit<'a>,
    /// Where sphere sets are kept.
    pub cache: &'a Cache,
    /// Who is told how far long work is.
    pub progress: &'a dyn Progress,
    /// The clock.
    pub clock: &'a dyn Clock,
    /// Version and commit of the program.
    pub revision: &'a str,
}

/// How an experiment is run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Threads, if other than the experiment's.
    pub threads: Option<usize>,
    /// Fewer samples, one frame, three timed rounds.
    pub quick: bool,
    /// Go on with the journal that is there.
    pub resume: bool,
    /// Where pictures, results and the journal go; without it nothing is written, timed or pictured.
    pub out: Option<PathBuf>,
    /// Refuse scenes that are read from other files than these.
    pub inputs: Option<Vec<InputFile>>,
}

/// Runs `experiment` and returns its results; with [`RunOptions::out`], `results.json` and its company lie there.
pub fn run(experiment: &Experiment, tools: &Tools<'_>, options: &RunOptions) -> Result<Results, HarnessError> {
    let plan = Plan::new(experiment, tools.strategies, options.quick)?;
    if let Some(expected) = &options.inputs {
        let changes = inputs::changes(expected, &plan.inputs);
        if !changes.is_empty() {
            let problem = format!(
                "the baseline was made from other files, so that errors can't be compared: {}; make it again",
                changes.join(", ")
            );
            return Err(HarnessError::in_file(&experiment.path, problem));
        }
    }
    let timing_threads = plan.timing.and_then(|timing| timing.threads).map(|threads| threads.get());
    let threads = options.threads.or(timing_threads).unwrap_or_else(threads::available);
    let mut results = Results {
        schema: SCHEMA.into(),
        experiment: experiment.name.clone(),
        claim: experiment.claim.clone(),
        experiment_hash: blake3::hash(experiment.text.as_bytes()).to_hex().to_string(),
        quick: options.quick,
        inputs: Some(plan.inputs.clone()),
        revision: tools.revision.to_owned(),
        machine: machine::describe(threads),
        strategies: tools.strategies.iter().map(|strategy| strategy.info().name.to_owned()).collect(),
        scenes: Vec::new(),
        runs: Vec::new(),
        differences: Vec::new(),
        pictures: Vec::new(),
    };
    let header = Header {
        schema: journal::SCHEMA.into(),
        experiment_hash: results.experiment_hash.clone(),
        quick: options.quick,
        threads,
        revision: tools.revision.to_owned(),
        program: machine::program_hash(),
        inputs: plan.inputs.clone(),
    };
    let (place, known) = match &options.out {
        None => (None, Known::default()),
        Some(out) => match Beginning::of(out, &plan.outputs(), &header, options.resume, tools.progress)? {
            Beginning::Finished(results) => return Ok(*results),
            Beginning::Open(open) => (Some((open.folder, open.journal)), open.known),
        },
    };
    let truth_cache = place.as_ref().map_or_else(Cache::disabled, |(folder, _)| folder.truths());
    let mut session = Session { tools, plan: &plan, threads, place, known, truth_cache };
    threads::with_threads(Some(threads), || {
        for (number, (scene, frames)) in plan.scenes.iter().enumerate() {
            let mut scene = scene.clone();
            scene.notes.iter().for_each(|note| tools.progress.note(note));
            if plan.needs_spheres(tools.strategies) {
                for note in scene.build_spheres(tools.cache, tools.progress)? {
                    tools.progress.note(&format!("{}: {note}", scene.name));
                }
            }
            results.scenes.push(SceneFacts {
                name: scene.name.clone(),
                vertices: scene.vertex_count(),
                triangles: scene.objects.iter().map(|object| object.mesh.triangles.len()).sum(),
                spheres: scene.built_sphere_count(),
                published: experiment.scenes[number].published.clone(),
            });
            for (place, &frame) in frames.iter().enumerate() {
                for (kind_place, &kind) in plan.receivers.iter().enumerate() {
                    let pictured = place == 0 && kind_place == 0;
                    session.group(&scene, frame, kind, pictured, &mut results)?;
                }
            }
        }
        Ok::<(), HarnessError>(())
    })??;
    if let Some((mut folder, journal)) = session.place.take() {
        crate::report::write_all(&results, &mut |file, bytes| folder.write(file, bytes))?;
        folder.remove_truths();
        journal.finish()?;
    }
    Ok(results)
}

struct Session<'a> {
    tools: &'a Tools<'a>,
    plan: &'a Plan,
    threads: usize,
    /// Where it is written, if it is.
    place: Option<(OutFolder, Journal)>,
    known: Known,
    truth_cache: Cache,
}

/// A strategy that is ready to be timed.
struct Ready {
    key: String,
    baked: Box<dyn Baked>,
}

/// The references of a group, each with its samples per receiver; the mesh first.
type References = Vec<(ReferenceKind, Reference, usize)>;

impl Session<'_> {
    /// All strategies on one frame and kind of receivers.
    fn group(
        &mut self,
        scene: &Scene,
        index: usize,
        kind: ReceiverKind,
        pictured: bool,
        results: &mut Results,
    ) -> Result<(), HarnessError> {
        let frame = scene.frame(index);
        let tracer = Tracer::new(&frame);
        let camera = self.plan.camera(scene);
        let pictured = pictured && self.place.is_some() && !self.plan.pictured.is_empty();
        let (receivers, projection) = match kind {
            ReceiverKind::Vertices => {
                let projection = pictured.then(|| Projection::of_vertices(&tracer, &frame, &camera));
                (ReceiverBuffer::vertices(&frame), projection)
            }
            ReceiverKind::Pixels => {
                let (receivers, projection) = Projection::of_pixels(&tracer, &camera);
                (receivers, pictured.then_some(projection))
            }
        };
        drop(tracer);
        if receivers.is_empty() {
            let problem =
                format!("scene `{}`, frame {index}: no {kind} to score; does the camera see anything?", scene.name);
            return Err(HarnessError::input(problem));
        }
        let blank = |variant: &Variant| Run {
            scene: scene.name.clone(),
            frame: index,
            receivers: kind.to_string(),
            receiver_count: receivers.len(),
            strategy: variant.name.clone(),
            label: variant.label.clone(),
            params: variant
                .params
                .iter()
                .map(|(name, value)| (name.to_owned(), serde_json::to_value(value).unwrap_or_default()))
                .collect(),
            status: Status::Failed,
            reason: None,
            error: None,
            truth: None,
            time: None,
            memory: None,
            details: Vec::new(),
        };
        let references = self.references(&frame, kind, &receivers)?;
        let exposure = projection.as_ref().map_or(1.0, |p| p.picture(&references[0].1.radiance, Vec3::ZERO).exposure());
        if projection.is_some() && camera.resolution.iter().any(|&side| (side as usize) < WINDOW) {
            let [width, height] = camera.resolution;
            let note = format!(
                "{}: SSIM isn't defined for pictures of {width} by {height}, only from {WINDOW} by {WINDOW} on",
                scene.name
            );
            self.tools.progress.note(&note);
        }
        if let Some(projection) = &projection {
            self.picture_truth(scene, index, projection, &references[0].1, exposure)?;
        }
        self.reference_rows(scene, &blank, &references, results);

        let mut ready = Vec::new();
        // Of variants that are compared with each other, by place.
        let mut shaded = BTreeMap::new();
        for (place, variant) in self.plan.variants.iter().enumerate() {
            let run = blank(variant);
            let key = run.key();
            let scored = self.known.scored.get(&key).cloned();
            let to_picture = projection.is_some()
                && self.plan.pictured.contains(&variant.key())
                && !self.known.pictured.contains_key(&key);
            let finished = scored.as_ref().is_some_and(|runs| runs.iter().any(|run| run.status != Status::Ok));
            if finished || (scored.is_some() && !to_picture && self.missing_samples(&key) == 0) {
                continue;
            }
            let (runs, baked, radiance) = self.score(&frame, receivers.view(), variant, run, &references);
            if scored.is_none() {
                self.append(Entry::Scored(runs.clone()))?;
                self.known.scored.insert(key.clone(), runs);
            }
            if let (Some(projection), Some(radiance), true) = (&projection, &radiance, to_picture) {
                let picture = projection.picture(radiance, Vec3::ZERO);
                let truth = projection.picture(&references[0].1.radiance, Vec3::ZERO);
                let similarity = Similarity::between(&picture, &truth, exposure);
                let files = self.write_pictures(
                    scene,
                    index,
                    &variant.label,
                    &picture,
                    Some((&truth, &references[0].1)),
                    exposure,
                )?;
                self.append(Entry::Pictured { key: Some(key.clone()), files: files.clone(), similarity })?;
                self.known.pictured.insert(key.clone(), (files, similarity));
            }
            if let (Some(baked), true) = (baked, self.plan.timing.is_some() && self.place.is_some()) {
                ready.push(Ready { key, baked });
            }
            if self.plan.is_compared(place) {
                shaded.insert(place, radiance);
            }
        }
        self.time(scene, &frame, &receivers, &mut ready)?;
        let difference = format!("{} {index} {kind} difference", scene.name);
        let to_draw =
            self.plan.difference.filter(|_| projection.is_some() && !self.known.pictured.contains_key(&difference));
        for place in self.plan.pairs.iter().chain(&to_draw).flatten().copied() {
            let variant = &self.plan.variants[place];
            shaded
                .entry(place)
                .or_insert_with(|| self.score(&frame, receivers.view(), variant, blank(variant), &references).2);
        }
        let both = |[a, b]: [usize; 2]| shaded.get(&a)?.as_ref().zip(shaded.get(&b)?.as_ref());
        if let (Some(projection), Some(pair)) = (&projection, to_draw)
            && let Some((first, second)) = both(pair)
        {
            let label = self.plan.difference_label(pair);
            let [first, second] = [first, second].map(|radiance| projection.picture(radiance, Vec3::ZERO));
            let picture = first.magnified_difference(&second, DIFFERENCE_FACTOR);
            let files = self.write_pictures(scene, index, &label, &picture, None, exposure)?;
            self.append(Entry::Pictured {
                key: Some(difference.clone()),
                files: files.clone(),
                similarity: Similarity::default(),
            })?;
            self.known.pictured.insert(difference.clone(), (files, Similarity::default()));
        }
        for &pair in &self.plan.pairs {
            let [a, b] = pair.map(|place| blank(&self.plan.variants[place]));
            let weights = &references[0].1.weights;
            let difference = both(pair).and_then(|(first, second)| difference_between(first, second, weights, a, b));
            results.differences.extend(difference);
        }

        results.pictures.extend(
            self.known
                .truths
                .iter()
                .filter(|files| files.scene == scene.name && files.frame == index && projection.is_some())
                .cloned(),
        );
        for variant in &self.plan.variants {
            let key = blank(variant).key();
            let picture = self.known.pictured.get(&key);
            for mut run in self.known.scored.get(&key).cloned().unwrap_or_default() {
                if let (Some(time), Some(samples)) = (&run.time, self.known.samples.get(&key)) {
                    run.time = Some(TimeFigures::of(time.bake_secs, time.threads, samples.clone()));
                }
                if let (Some(error), Some((_, similarity))) = (&mut run.error, picture)
                    && error.reference == ReferenceKind::Mesh.to_string()
                {
                    error.similarity = *similarity;
                }
                results.runs.push(run);
            }
            results.pictures.extend(picture.map(|(files, _)| files.clone()));
        }
        results.pictures.extend(self.known.pictured.get(&difference).map(|(files, _)| files.clone()));
        Ok(())
    }

    fn references(
        &self,
        frame: &Frame<'_>,
        receivers_are: ReceiverKind,
        receivers: &ReceiverBuffer,
    ) -> Result<References, HarnessError> {
        let tracer = ReferenceTracer {
            accuracy: self.plan.accuracy,
            band_limit: self.tools.band_limit,
            cache: &self.truth_cache,
            progress: self.tools.progress,
        };
        let weights = Arc::new(match (receivers_are, self.plan.weights) {
            (ReceiverKind::Vertices, Weighting::Area) => ReceiverWeights::by_area(frame, receivers),
            _ => ReceiverWeights::equal(receivers.len()),
        });
        // Who only compares with a baseline shows no classes.
        let by_class = self.plan.classes && self.place.is_some();
        let hiders: Arc<[Hider]> = match by_class {
            true => hiders(&Tracer::new(frame), receivers.view(), self.tools.progress).into(),
            false => Arc::default(),
        };
        let kinds = std::iter::once(ReferenceKind::Mesh).chain(self.plan.other_references());
        let traced = kinds.map(|kind| {
            let scoring = (weights.clone(), hiders.clone());
            let (reference, samples) = tracer.trace(frame.scene, frame.index, receivers.view(), kind, scoring)?;
            Ok((kind, reference, samples))
        });
        let mut references = traced.collect::<Result<References, HarnessError>>()?;
        // Relative errors share one denominator, so that they can be compared between references.
        if let Some(mean) = references.first().map(|(_, mesh, _)| mesh.unshadowed_mean) {
            references.iter_mut().for_each(|(_, reference, _)| reference.unshadowed_mean = mean);
        }
        Ok(references)
    }

    /// How far the other references are from the mesh's: what a strategy without any error of its own would show.
    fn reference_rows(
        &self,
        scene: &Scene,
        blank: &dyn Fn(&Variant) -> Run,
        references: &References,
        results: &mut Results,
    ) {
        let Some(((_, mesh, _), others)) = references.split_first() else { return };
        for (kind, other, samples) in others {
            let both = mesh.with_noise_of_difference(other);
            let Some(error) = figures(ReferenceKind::Mesh, scene, &other.radiance, &both) else { continue };
            let Some(variant) = self.plan.variants.first() else { continue };
            results.runs.push(Run {
                strategy: "reference".into(),
                label: format!("reference: {kind}"),
                params: BTreeMap::from([("reference".to_owned(), kind.to_string().into())]),
                status: Status::Ok,
                error: Some(error),
                truth: Some(truth_figures(&both, *samples)),
                ..blank(variant)
            });
        }
    }

    /// Bakes, prepares and shades once, and compares with every reference.
    fn score(
        &self,
        frame: &Frame<'_>,
        receivers: halfshade_scene::Receivers<'_>,
        variant: &Variant,
        run: Run,
        references: &References,
    ) -> (Vec<Run>, Option<Box<dyn Baked>>, Option<RadianceBuffer>) {
        let ended = |status, reason: String| (vec![Run { status, reason: Some(reason), ..run.clone() }], None, None);
        let refused = |error| match error {
            StrategyError::Unsupported(reason) => ended(Status::Unsupported, reason),
            StrategyError::Failed(reason) => ended(Status::Failed, reason),
        };
        let strategy = &self.tools.strategies[variant.strategy];
        let missing = strategy.info().effects.missing(Effects::required_by(frame.scene));
        if !missing.is_empty() {
            return ended(Status::Unsupported, format!("can't model {missing}"));
        }
        let (bake_secs, baked) =
            time_secs(self.tools.clock, || strategy.bake(frame.scene, &variant.params, self.tools.progress));
        let mut baked = match baked {
            Ok(baked) => baked,
            Err(error) => return refused(error),
        };
        if let Err(error) = baked.prepare(frame) {
            return refused(error);
        }
        let mut radiance = RadianceBuffer::zeros(receivers.len());
        shade_all(baked.as_ref(), receivers, &mut radiance);
        let broken = count_not_finite(&radiance);
        if broken > 0 {
            return ended(Status::Failed, format!("{broken} of {} values are not finite", 3 * radiance.len()));
        }
        let footprint = baked.footprint();
        let memory = Memory {
            bytes: footprint.bytes(),
            parts: footprint.parts.iter().map(|(part, bytes)| ((*part).to_owned(), *bytes)).collect(),
        };
        let details = if self.plan.details { baked.details() } else { Vec::new() };
        let details = details.into_iter().map(|detail| Detail { name: detail.name, values: detail.values });
        let details: Vec<Detail> = details.collect();
        let runs = references
            .iter()
            .filter(|(kind, ..)| self.plan.compares(variant, *kind))
            .filter_map(|(kind, reference, samples)| {
                Some(Run {
                    status: Status::Ok,
                    error: Some(figures(*kind, frame.scene, &radiance, reference)?),
                    truth: Some(truth_figures(reference, *samples)),
                    time: Some(TimeFigures::of(bake_secs, self.threads, Vec::new())),
                    memory: Some(memory.clone()),
                    details: details.clone(),
                    ..run.clone()
                })
            })
            .collect();
        (runs, Some(baked), Some(radiance))
    }

    fn missing_samples(&self, key: &str) -> usize {
        let wanted = self.plan.timing.map_or(0, |timing| timing.repeats.get() as usize);
        wanted.saturating_sub(self.known.samples.get(key).map_or(0, Vec::len))
    }

    /// Rounds over all strategies, so that a disturbance meets all alike; whoever begins changes from round to round.
    /// Before every timed frame its neighbour is prepared, untimed: what a frame changes is really new to it.
    fn time(
        &mut self,
        scene: &Scene,
        frame: &Frame<'_>,
        receivers: &ReceiverBuffer,
        ready: &mut [Ready],
    ) -> Result<(), HarnessError> {
        let Some(timing) = self.plan.timing.filter(|_| !ready.is_empty()) else { return Ok(()) };
        let neighbour = scene.frame(if frame.index > 0 { frame.index - 1 } else { 1 });
        let rounds = ready.iter().map(|ready| self.missing_samples(&ready.key)).max().unwrap_or(0);
        let all_rounds = timing.warm_up as usize + rounds;
        self.tools.progress.start(&format!("timing {}", scene.name), (all_rounds * ready.len()) as u64);
        let mut radiance = RadianceBuffer::zeros(receivers.len());
        for round in 0..all_rounds {
            let count = ready.len();
            for place in 0..count {
                let Ready { key, baked } = &mut ready[(place + round) % count];
                let warming_up = round < timing.warm_up as usize;
                if !warming_up && self.missing_samples(key) == 0 {
                    continue;
                }
                let sample = timed_frame(self.tools.clock, baked.as_mut(), &neighbour, frame, receivers, &mut radiance)
                    .map_err(|error| HarnessError::input(format!("{key}: preparing a second time failed: {error}")))?;
                if !warming_up {
                    self.append(Entry::Timed { key: key.clone(), sample })?;
                    self.known.samples.entry(key.clone()).or_default().push(sample);
                }
                self.tools.progress.advance(1);
            }
        }
        Ok(())
    }

    fn picture_truth(
        &mut self,
        scene: &Scene,
        frame: usize,
        projection: &Projection,
        truth: &Reference,
        exposure: f32,
    ) -> Result<(), HarnessError> {
        if self.known.truths.iter().any(|files| files.scene == scene.name && files.frame == frame) {
            return Ok(());
        }
        let picture = projection.picture(&truth.radiance, Vec3::ZERO);
        let files = self.write_pictures(scene, frame, TRUTH_LABEL, &picture, None, exposure)?;
        self.append(Entry::Pictured { key: None, files: files.clone(), similarity: Similarity::default() })?;
        self.known.truths.push(files);
        Ok(())
    }

    fn write_pictures(
        &mut self,
        scene: &Scene,
        frame: usize,
        label: &str,
        picture: &Picture,
        truth: Option<(&Picture, &Reference)>,
        exposure: f32,
    ) -> Result<PictureFiles, HarnessError> {
        let base = file_names::picture(&scene.name, frame, label);
        let mut write = |ending: &str, bytes: Result<Vec<u8>, String>| -> Result<String, HarnessError> {
            let file = PathBuf::from(format!("{base}{ending}"));
            let bytes = bytes.map_err(|problem| HarnessError::in_file(&file, problem))?;
            if let Some((folder, _)) = &mut self.place {
                folder.write(&file, &bytes)?;
            }
            Ok(format!("{base}{ending}"))
        };
        let error = truth.map(|(truth, reference)| (picture.minus(truth), truth, reference));
        let mut layers = vec![("", picture)];
        if let Some((error, truth, _)) = &error {
            layers.extend([("truth", *truth), ("error", error)]);
        }
        Ok(PictureFiles {
            scene: scene.name.clone(),
            frame,
            label: label.to_owned(),
            exr: write(".exr", exr_bytes(&layers))?,
            png: write(".png", png_bytes(&picture.to_srgb(exposure)))?,
            error_png: match &error {
                Some((error, _, reference)) => {
                    Some(write(".error.png", png_bytes(&signed_error(error, reference.unshadowed_mean)))?)
                }
                None => None,
            },
            exposure,
        })
    }

    fn append(&mut self, entry: Entry) -> Result<(), HarnessError> {
        self.place.as_mut().map_or(Ok(()), |(_, journal)| journal.append(&entry))
    }
}

/// One frame by the clock, after its neighbour was prepared untimed.
fn timed_frame(
    clock: &dyn Clock,
    baked: &mut dyn Baked,
    neighbour: &Frame<'_>,
    frame: &Frame<'_>,
    receivers: &ReceiverBuffer,
    radiance: &mut RadianceBuffer,
) -> Result<Sample, StrategyError> {
    baked.prepare(neighbour)?;
    let (prepare_secs, prepared) = time_secs(clock, || baked.prepare(frame));
    prepared?;
    let (shade_secs, ()) = time_secs(clock, || shade_all(baked, receivers.view(), radiance));
    Ok(Sample { prepare_secs, shade_secs })
}

/// `None` if there is nothing to compare.
fn figures(
    kind: ReferenceKind,
    scene: &Scene,
    radiance: &RadianceBuffer,
    reference: &Reference,
) -> Option<ErrorFigures> {
    let transport = if scene.bounces == 0 { "direct".into() } else { format!("bounces={}", scene.bounces) };
    Some(ErrorFigures {
        reference: kind.to_string(),
        transport,
        metrics: compare(radiance, reference)?,
        weights: reference.weights.weighting(),
        classes: by_class(radiance, reference),
        similarity: Similarity::default(),
    })
}

/// `None` if there is nothing to compare.
fn difference_between(
    first: &RadianceBuffer,
    second: &RadianceBuffer,
    weights: &Arc<ReceiverWeights>,
    a: Run,
    b: Run,
) -> Option<Difference> {
    if [first.len(), weights.values().len()] != [second.len(); 2] {
        return None;
    }
    let mean = mean(second, weights);
    let reference = Reference::exact(second.clone(), mean, weights.clone());
    let Metrics { bias, mae, max, .. } = compare(first, &reference)?;
    let Run { scene, frame, receivers, label: first, .. } = a;
    Some(Difference { scene, frame, receivers, first, second: b.label, mean, bias, mae, max })
}

fn truth_figures(reference: &Reference, samples: usize) -> TruthFigures {
    TruthFigures {
        samples: samples as u64,
        rms_standard_error: reference.rms_standard_error(),
        unshadowed_mean: reference.unshadowed_mean,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::mock::MockClock;
    use halfshade_scene::{Environment, RadianceMut, Receivers};
    use halfshade_strategy::Footprint;
    use std::time::Duration;

    /// Takes 2 ms to prepare the frame it is asked for and 100 ms for any other, and 5 ms to shade.
    struct Steady(Arc<MockClock>);

    impl Baked for Steady {
        fn footprint(&self) -> Footprint {
            Footprint::default()
        }

        fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
            self.0.advance(Duration::from_millis(if frame.index == 7 { 2 } else { 100 }));
            Ok(())
        }

        fn shade(&self, _receivers: Receivers<'_>, _out: RadianceMut<'_>) {
            self.0.advance(Duration::from_millis(5));
        }
    }

    #[test]
    fn preparing_and_shading_are_charged_apart_and_the_neighbour_is_free() {
        let scene = Scene { frame_count: 10, ..Scene::at_rest("empty", Vec::new(), Environment::constant(Vec3::ONE)) };
        let clock = Arc::new(MockClock::default());
        let mut receivers = ReceiverBuffer::default();
        receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
        let mut radiance = RadianceBuffer::zeros(1);
        let mut steady = Steady(clock.clone());
        let (neighbour, frame) = (scene.frame(6), scene.frame(7));
        let sample = timed_frame(clock.as_ref(), &mut steady, &neighbour, &frame, &receivers, &mut radiance).unwrap();
        assert_eq!(sample, Sample { prepare_secs: 0.002, shade_secs: 0.005 });
        let figures = TimeFigures::of(1.0, 2, vec![sample; 3]);
        assert!((figures.frames_per_sec.unwrap() - 1.0 / 0.007).abs() < 1e-9);
    }

    #[test]
    fn two_strategies_differ_by_what_lies_between_them() {
        let blank = |label: &str| Run { label: label.into(), ..crate::results::tests::example().runs[0].clone() };
        let buffer = |values: [f32; 2]| RadianceBuffer { channels: std::array::from_fn(|_| values.to_vec()) };
        let weights = Arc::new(ReceiverWeights::equal(2));
        let difference =
            |second: &RadianceBuffer| difference_between(&buffer([1.0, 3.0]), second, &weights, blank("a"), blank("b"));
        let found = difference(&buffer([2.0, 2.5])).unwrap();
        assert_eq!((found.first.as_str(), found.second.as_str(), found.scene.as_str()), ("a", "b", "vases"));
        assert_eq!((found.mean, found.bias, found.mae, found.max), (2.25, -0.25, 0.75, 1.0));
        assert!(difference(&RadianceBuffer::zeros(0)).is_none());
    }
}
