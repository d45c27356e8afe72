//! References that the strategies of a group are compared with.

use super::setup::Setup;
use crate::{
    HarnessError, ReceiverKind, ReceiverWeights, Reference, ReferenceKind, reference::ReferenceTracer,
    results::TruthFigures,
};
use halfshade_scene::{Frame, ReceiverBuffer};
use halfshade_truth::{Hider, Tracer, hiders};
use std::sync::Arc;

/// One reference.
pub(super) struct Traced {
    pub(super) kind: ReferenceKind,
    pub(super) reference: Reference,
    /// Samples per receiver.
    pub(super) samples: usize,
}

impl Traced {
    /// Its entry in the results, with the noise of `reference`, which may be that of a difference to it.
    pub(super) fn figures(&self, reference: &Reference) -> TruthFigures {
        TruthFigures {
            samples: self.samples as u64,
            rms_standard_error: reference.rms_standard_error(),
            unshadowed_mean: reference.unshadowed_mean,
        }
    }
}

/// The references of a group.
pub(super) struct References {
    pub(super) mesh: Traced,
    pub(super) others: Vec<Traced>,
}

impl References {
    /// Traces all that the plan asks for.
    pub(super) fn trace(
        setup: &Setup<'_>,
        frame: &Frame<'_>,
        receivers_are: ReceiverKind,
        receivers: &ReceiverBuffer,
    ) -> Result<Self, HarnessError> {
        let tracer = ReferenceTracer {
            accuracy: setup.plan.accuracy,
            band_limit: setup.tools.band_limit,
            cache: &setup.truth_cache,
            progress: setup.tools.progress,
        };
        let weights = Arc::new(ReceiverWeights::of_kind(receivers_are, setup.plan.weights, frame, receivers));
        let hiders: Arc<[Hider]> = match setup.plan.classes {
            true => hiders(&Tracer::new(frame), receivers.view(), setup.tools.progress).into(),
            false => Arc::default(),
        };
        let trace = |kind| {
            let scoring = (weights.clone(), hiders.clone());
            let (reference, samples) = tracer.trace(frame.scene, frame.index, receivers.view(), kind, scoring)?;
            Ok::<_, HarnessError>(Traced { kind, reference, samples })
        };
        let mesh = trace(ReferenceKind::Mesh)?;
        let mut others = setup.plan.other_references().into_iter().map(trace).collect::<Result<Vec<_>, _>>()?;
        // Relative errors share one denominator, so that they can be compared between references.
        for Traced { reference, .. } in &mut others {
            reference.unshadowed_mean = mesh.reference.unshadowed_mean;
            reference.unshadowed = mesh.reference.unshadowed.clone();
        }
        Ok(Self { mesh, others })
    }

    /// The mesh first.
    pub(super) fn all(&self) -> impl Iterator<Item = &Traced> {
        std::iter::once(&self.mesh).chain(&self.others)
    }
}
