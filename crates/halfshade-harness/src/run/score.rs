//! How far a strategy is from the references: baked, prepared and shaded once.

use super::{group::Group, references::Traced, setup::Setup, stages::stage_errors};
use crate::{
    Reference, ReferenceKind, Variant,
    ability::inability,
    classes::by_class,
    clock::time_secs,
    image_metrics::Similarity,
    metrics::compare,
    results::{Detail, ErrorFigures, Memory, REFERENCE, Run, Status, TimeFigures},
    shading::{count_not_finite, shade_frame},
};
use halfshade_scene::{RadianceBuffer, Scene};
use halfshade_strategy::{Baked, StrategyError};
use std::collections::BTreeMap;

/// A variant after it was scored.
pub(super) struct Scored {
    /// One against each reference; or the one that says why there is none.
    pub(super) runs: Vec<Run>,
    pub(super) shaded: Option<Shaded>,
}

/// A baked strategy that has shaded, and its radiance.
pub(super) struct Shaded {
    pub(super) baked: Box<dyn Baked>,
    pub(super) radiance: RadianceBuffer,
}

/// Why a variant has no scores.
pub(super) struct Refusal {
    status: Status,
    reason: String,
}

impl Refusal {
    fn failed(reason: String) -> Self {
        Self { status: Status::Failed, reason }
    }

    fn unsupported(reason: String) -> Self {
        Self { status: Status::Unsupported, reason }
    }
}

impl From<StrategyError> for Refusal {
    fn from(error: StrategyError) -> Self {
        match error {
            StrategyError::Unsupported(reason) => Self::unsupported(reason),
            StrategyError::Failed(reason) => Self::failed(reason),
        }
    }
}

const NO_KERNELS: &str = "no kernels for graphics devices yet: run it with device `cpu`";

/// Bakes, prepares and shades the variant at `place` once, and compares with every reference.
pub(super) fn score(setup: &Setup<'_>, group: &Group<'_>, place: usize) -> Scored {
    let blank = &group.rows[place].blank;
    match shade_with(setup, group, &setup.plan.variants[place]) {
        Ok((bake_secs, shaded)) => {
            Scored { runs: compared(setup, group, place, bake_secs, &shaded), shaded: Some(shaded) }
        }
        Err(Refusal { status, reason }) => {
            Scored { runs: vec![Run { status, reason: Some(reason), ..blank.clone() }], shaded: None }
        }
    }
}

/// Seconds of baking, and what a variant has shaded.
pub(super) fn shade_with(setup: &Setup<'_>, group: &Group<'_>, variant: &Variant) -> Result<(f64, Shaded), Refusal> {
    let (tools, frame) = (setup.tools, &group.frame);
    let strategy = tools.strategy(variant).ok_or_else(|| Refusal::unsupported(NO_KERNELS.into()))?;
    if let Some(reason) = inability(strategy, frame.scene, tools.strategies) {
        return Err(Refusal::unsupported(reason));
    }
    let (bake_secs, baked) = time_secs(tools.clock, || strategy.bake(frame.scene, &variant.params, tools.progress));
    let mut baked = baked?;
    let radiance = shade_frame(baked.as_mut(), frame, group.receivers.view())?;
    let broken = count_not_finite(&radiance);
    if broken > 0 {
        return Err(Refusal::failed(format!("{broken} of {} values are not finite", 3 * radiance.len())));
    }
    Ok((bake_secs, Shaded { baked, radiance }))
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
        Some(Run {
            status: Status::Ok,
            error: Some(figures(traced.kind, group.frame.scene, radiance, &traced.reference)?),
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
