//! Error by class of what hides the light at a receiver: its own object, another one, the ground, nothing.

use crate::{
    errors::Reference,
    metrics::{Metrics, compare_class},
};
use halfshade_scene::RadianceBuffer;
use halfshade_truth::Hider;
use serde::{Deserialize, Serialize};

/// How far a run is off where one class of things hides the light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassError {
    /// `own`, `other`, `ground` or `nothing`.
    pub class: String,
    /// How many receivers of the class count.
    pub receivers: usize,
    /// Their share of the weight of all.
    pub share: f64,
    /// Over them; relative to the same mean unshadowed radiance as those over all.
    #[serde(flatten)]
    pub metrics: Metrics,
}

/// The name of a class in results.
pub fn name(class: Hider) -> &'static str {
    match class {
        Hider::Own => "own",
        Hider::Other => "other",
        Hider::Ground => "ground",
        Hider::Nothing => "nothing",
    }
}

/// Errors of every class that has receivers; nothing if the reference knows no classes.
pub fn by_class(radiance: &RadianceBuffer, reference: &Reference) -> Vec<ClassError> {
    Hider::ALL
        .into_iter()
        .filter_map(|class| {
            let (share, metrics) = compare_class(radiance, reference, class)?;
            let counted = reference.hiders.iter().zip(reference.weights.values());
            let receivers = counted.filter(|(hider, weight)| **hider == class && **weight > 0.0).count();
            Some(ClassError { class: name(class).to_owned(), receivers, share, metrics })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weights::ReceiverWeights;
    use std::sync::Arc;

    #[test]
    fn classes_part_the_receivers() {
        let buffer = |values: [f32; 4]| RadianceBuffer { channels: std::array::from_fn(|_| values.to_vec()) };
        let hiders = [Hider::Nothing, Hider::Own, Hider::Own, Hider::Ground].into();
        let weights = Arc::new(ReceiverWeights::equal(4));
        let reference = Reference { hiders, ..Reference::exact(buffer([1.0; 4]), 2.0, weights) };
        let found = by_class(&buffer([1.0, 2.0, 4.0, 0.0]), &reference);
        let told: Vec<_> =
            found.iter().map(|it| (it.class.as_str(), it.receivers, it.share, it.metrics.bias)).collect();
        assert_eq!(told, [("own", 2, 0.5, 2.0), ("ground", 1, 0.25, -1.0), ("nothing", 1, 0.25, 0.0)]);
        assert_eq!(found[1].metrics.rel_rmse, Some(0.5));
        let unasked = Reference { hiders: Arc::default(), ..reference };
        assert!(by_class(&buffer([0.0; 4]), &unasked).is_empty());
    }
}
