//! How far two strategies are from each other.

use crate::{
    Metrics, ReceiverWeights, Reference,
    metrics::{compare, mean},
    results::{Difference, Run},
};
use halfshade_scene::RadianceBuffer;
use std::sync::Arc;

/// Radiance of the rows `a` and `b` beside each other; `None` if there is nothing to compare.
pub(super) fn difference_between(
    first: &RadianceBuffer,
    second: &RadianceBuffer,
    weights: &Arc<ReceiverWeights>,
    a: &Run,
    b: &Run,
) -> Option<Difference> {
    if [first.len(), weights.values().len()] != [second.len(); 2] {
        return None;
    }
    let mean = mean(second, weights);
    let reference = Reference::exact(second.clone(), mean, weights.clone());
    let Metrics { bias, mae, max, .. } = compare(first, &reference)?;
    Some(Difference {
        scene: a.scene.clone(),
        frame: a.frame,
        receivers: a.receivers.clone(),
        first: a.label.clone(),
        second: b.label.clone(),
        mean,
        bias,
        mae,
        max,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_strategies_differ_by_what_lies_between_them() {
        let blank = |label: &str| Run { label: label.into(), ..crate::results::tests::example().runs[0].clone() };
        let buffer = |values: [f32; 2]| RadianceBuffer { channels: std::array::from_fn(|_| values.to_vec()) };
        let weights = Arc::new(ReceiverWeights::equal(2));
        let difference = |second: &RadianceBuffer| {
            difference_between(&buffer([1.0, 3.0]), second, &weights, &blank("a"), &blank("b"))
        };
        let found = difference(&buffer([2.0, 2.5])).unwrap();
        assert_eq!((found.first.as_str(), found.second.as_str(), found.scene.as_str()), ("a", "b", "vases"));
        assert_eq!((found.mean, found.bias, found.mae, found.max), (2.25, -0.25, 0.75, 1.0));
        assert!(difference(&RadianceBuffer::zeros(0)).is_none());
    }
}
