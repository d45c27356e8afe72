//! How far a strategy is from the references.

use super::{
    group::Group,
    references::Traced,
    setup::Setup,
    shade::{Refusal, Shaded, shade_with},
    stages::stage_errors,
};
use crate::{
    Reference, ReferenceKind,
    classes::by_class,
    image_metrics::Similarity,
    metrics::compare,
    results::{Detail, ErrorFigures, Memory, REFERENCE, Run, Status, TimeFigures},
    stability::{Stability, StabilityFigures},
};
use halfshade_scene::{RadianceBuffer, Scene};
use std::collections::BTreeMap;

/// A variant after it was scored.
pub(super) struct Scored {
    /// One against each reference; or the one that says why there is none.
    pub(super) runs: Vec<Run>,
    pub(super) shaded: Option<Shaded>,
}

/// Bakes, prepares and shades the variant at `place` once, and compares with every reference.
pub(super) fn score(setup: &Setup<'_>, group: &Group<'_>, place: usize) -> Scored {
    let blank = &group.rows[place].blank;
    match shade_with(setup, group, &setup.plan.variants[place]) {
        Ok((bake_secs, shaded)) => {
            Scored { runs: compared(setup, group, place, bake_secs, &shaded), shaded: Some(shaded) }
        }
        Err(Refusal { status, reason, not_finite }) => {
            let is_told = setup.plan.stability.is_some() && not_finite > 0;
            let stability = is_told.then_some(Stability { not_finite, figures: None });
            Scored { runs: vec![Run { status, reason: Some(reason), stability, ..blank.clone() }], shaded: None }
        }
    }
}

/// A run for each reference that the variant at `place` is compared with.
fn compared(setup: &Setup<'_>, group: &Group<'_>, place: usize, bake_secs: f64, shaded: &Shaded) -> Vec<Run> {
    let (plan, Shaded { baked, radiance }) = (setup.plan, shaded);
    let footprint = baked.footprint();
    let memory = Memory {
        bytes: footprint.bytes(),
        parts: footprint.parts.iter().map(|(part, bytes)| ((*part).to_owned(), *bytes)).collect(),
    };
    let details = if plan.details { baked.details() } else { Vec::new() };
    let details = details.into_iter().map(|detail| Detail { name: detail.name, values: detail.values });
    let details: Vec<Detail> = details.collect();
    let stages = |kind| match plan.stages && kind == ReferenceKind::Mesh {
        true => stage_errors(setup, group, place, radiance),
        false => Vec::new(),
    };
    let run_against = |traced: &Traced| {
        let error = figures(traced.kind, group.frame.scene, radiance, &traced.reference)?;
        let stability = plan.stability.filter(|_| traced.kind == ReferenceKind::Mesh).map(|_| Stability {
            not_finite: 0,
            figures: StabilityFigures::of(radiance, &traced.reference, &error.metrics, &group.neighbours),
        });
        Some(Run {
            status: Status::Ok,
            error: Some(error),
            stability,
            truth: Some(traced.figures(&traced.reference)),
            time: Some(TimeFigures::of(bake_secs, setup.threads, Vec::new())),
            memory: Some(memory.clone()),
            details: details.clone(),
            stages: stages(traced.kind),
            ..group.rows[place].blank.clone()
        })
    };
    let references = group.references.all().filter(|traced| plan.compares(&plan.variants[place], traced.kind));
    references.filter_map(run_against).collect()
}

/// How far the other references are from the mesh's: what a strategy without any error of its own would show.
pub(super) fn reference_rows(group: &Group<'_>) -> Vec<Run> {
    let mesh = &group.references.mesh.reference;
    let row = |other: &Traced| {
        let both = mesh.with_noise_of_difference(&other.reference);
        Some(Run {
            strategy: REFERENCE.into(),
            label: format!("reference: {}", other.kind),
            params: BTreeMap::from([("reference".to_owned(), other.kind.to_string().into())]),
            status: Status::Ok,
            error: Some(figures(ReferenceKind::Mesh, group.frame.scene, &other.reference.radiance, &both)?),
            truth: Some(other.figures(&both)),
            ..group.rows.first()?.blank.clone()
        })
    };
    group.references.others.iter().filter_map(row).collect()
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
