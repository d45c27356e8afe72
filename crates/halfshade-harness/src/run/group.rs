//! A group of measurements: all strategies on one frame and kind of receivers.

use super::{plan::PlannedGroup, references::References, setup::Setup};
use crate::{
    HarnessError, Picture, ReceiverKind, Variant,
    projection::Projection,
    results::{Run, Status},
    ssim::WINDOW,
    stability::joined_vertices,
};
use glam::Vec3;
use halfshade_scene::{Frame, RadianceBuffer, ReceiverBuffer, Scene};
use halfshade_truth::Tracer;
use std::{collections::BTreeMap, ops::Range};

/// One frame, its receivers, what they are compared with, and a row to fill in for each variant.
pub(super) struct Group<'a> {
    pub(super) frame: Frame<'a>,
    pub(super) kind: ReceiverKind,
    pub(super) receivers: ReceiverBuffer,
    pub(super) references: References,
    /// Pairs of receivers that are neighbours, if bounds on jumps are stated.
    pub(super) neighbours: Vec<[u32; 2]>,
    /// How pictures of the group are drawn, if any are.
    pub(super) view: Option<View>,
    /// One for each variant of the plan, in its order.
    pub(super) rows: Vec<Row>,
    /// Places of those that are run in this part.
    pub(super) own: Range<usize>,
}

/// Projection of receivers to pictures.
pub(super) struct View {
    projection: Projection,
    /// Factor for all PNGs, which is that of the truth's picture.
    pub(super) exposure: f32,
    /// Version of the program, which pictures tell.
    pub(super) program: String,
}

impl View {
    pub(super) fn picture(&self, radiance: &RadianceBuffer) -> Picture {
        self.projection.picture(radiance, Vec3::ZERO)
    }
}

/// A variant within a group.
pub(super) struct Row {
    /// Everything that is known before anything is measured.
    pub(super) blank: Run,
    /// Its [`Run::key`].
    pub(super) key: String,
}

impl<'a> Group<'a> {
    /// Places the receivers and traces the references.
    pub(super) fn new(setup: &Setup<'_>, scene: &'a Scene, planned: PlannedGroup) -> Result<Self, HarnessError> {
        let PlannedGroup { frame: index, kind, pictured, own, .. } = planned;
        let frame = scene.frame(index);
        let camera = scene.camera;
        let pictured = pictured && setup.is_kept && !setup.plan.pictured.is_empty();
        let tracer = Tracer::new(&frame);
        let has_bounds = setup.plan.stability.is_some();
        let (receivers, projection, neighbours) = match kind {
            ReceiverKind::Vertices => {
                let projection = pictured.then(|| Projection::of_vertices(&tracer, &frame, &camera));
                let neighbours = has_bounds.then(|| joined_vertices(scene));
                (ReceiverBuffer::vertices(&frame), projection, neighbours)
            }
            ReceiverKind::Pixels => {
                let (receivers, projection) = Projection::of_pixels(&tracer, &camera);
                let neighbours = has_bounds.then(|| projection.neighbours());
                (receivers, pictured.then_some(projection), neighbours)
            }
        };
        drop(tracer);
        if receivers.is_empty() {
            return Err(HarnessError::nothing_to_score(&scene.name, index, kind));
        }
        let references = References::trace(setup, &frame, kind, &receivers)?;
        let view = projection.map(|projection| {
            let exposure = projection.picture(&references.mesh.reference.radiance, Vec3::ZERO).exposure();
            View { projection, exposure, program: setup.tools.revision.to_owned() }
        });
        if view.is_some() && camera.resolution.iter().any(|&side| (side as usize) < WINDOW) {
            let [width, height] = camera.resolution;
            let note = format!(
                "{}: SSIM isn't defined for pictures of {width} by {height}, only from {WINDOW} by {WINDOW} on",
                scene.name
            );
            setup.tools.progress.note(&note);
        }
        let row = |variant| {
            let blank = blank(scene, index, kind, receivers.len(), variant);
            Row { key: blank.key(), blank }
        };
        let rows = setup.plan.variants.iter().map(row).collect();
        let neighbours = neighbours.unwrap_or_default();
        Ok(Self { frame, kind, receivers, references, neighbours, view, rows, own })
    }

    /// Whether its first run is one of this part, and with it what comes before all runs.
    pub(super) fn has_first(&self) -> bool {
        self.own.start == 0
    }

    /// Whether its last run is one of this part, and with it what comes after all runs.
    pub(super) fn has_last(&self) -> bool {
        self.own.end == self.rows.len()
    }
}

/// The row of a variant before anything is measured.
fn blank(scene: &Scene, frame: usize, kind: ReceiverKind, receiver_count: usize, variant: &Variant) -> Run {
    let params = variant.params.iter();
    let params: BTreeMap<_, _> =
        params.map(|(name, value)| (name.to_owned(), serde_json::to_value(value).unwrap_or_default())).collect();
    Run {
        scene: scene.name.clone(),
        frame,
        receivers: kind.to_string(),
        receiver_count,
        strategy: variant.name.clone(),
        device: variant.device,
        label: variant.label.clone(),
        params,
        status: Status::Failed,
        reason: None,
        error: None,
        truth: None,
        time: None,
        memory: None,
        stability: None,
        details: Vec::new(),
        stages: Vec::new(),
    }
}
