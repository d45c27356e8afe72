//! The error of a variant taken apart: stages of its method made exact one after the other.
//!
//! With M the radiance of the variant, M_k that with the first k stages made exact, and T the truth, the error is a sum of changes,
//!
//! ```text
//! M - T = (M - M_1) + (M_1 - M_2) + .. + (M_n - T_s) + (T_s - T),
//! ```
//!
//! T_s the truth of the sphere sets, where a method knows no other geometry. The share of a change c in the mean squared error is
//! ⟨c, M - T⟩ / ⟨M - T, M - T⟩, ⟨⟩ the mean over receivers, by weight, and channels: shares sum to 1. What the truth's noise adds is
//! taken off the whole and off the change that ends at T.

use super::{
    group::Group,
    references::Traced,
    setup::Setup,
    shade::{Shaded, shade_with},
};
use crate::{ReceiverWeights, Reference, ReferenceKind, Variant, classes, errors::square, results::StageError};
use halfshade_scene::RadianceBuffer;
use halfshade_truth::Hider;
use std::collections::BTreeMap;

/// Name of what is left when all stages are exact.
const REST: &str = "rest";
/// Name of the difference of sphere sets and meshes.
const GEOMETRY: &str = "spheres instead of meshes";

/// Stages of the variant at `place`, whose radiance is `radiance`; none where the truth can't resolve the error.
pub(super) fn stage_errors(
    setup: &Setup<'_>,
    group: &Group<'_>,
    place: usize,
    radiance: &RadianceBuffer,
) -> Vec<StageError> {
    let variant = &setup.plan.variants[place];
    let Some(strategy) = setup.tools.strategy(variant) else { return Vec::new() };
    let info = strategy.info();
    let mut exact = variant.clone();
    // Radiance from the variant's own to the truth, each with the name of the change that leads to it.
    let mut chain: Vec<(&str, RadianceBuffer)> = Vec::new();
    for stage in info.stages {
        let Ok(params) = info.made_exact(&exact.params, stage) else { continue };
        if params == exact.params {
            continue;
        }
        let next = Variant { params, ..exact.clone() };
        // A stage that can't be made exact here, such as by rays where light is reflected, stays a part of the rest.
        if let Ok((_, Shaded { radiance, .. })) = shade_with(setup, group, &next) {
            chain.push((stage.name, radiance));
            exact = next;
        }
    }
    let truth = &group.references.mesh.reference;
    let is_spheres = |traced: &&Traced| traced.kind == ReferenceKind::Spheres;
    match group.references.others.iter().find(is_spheres).filter(|_| strategy.needs_spheres()) {
        Some(spheres) => {
            chain.push((REST, spheres.reference.radiance.clone()));
            chain.push((GEOMETRY, truth.radiance.clone()));
        }
        None => chain.push((REST, truth.radiance.clone())),
    }
    shares(radiance, &chain, truth)
}

/// Shares of the changes along `chain`, which begins at `radiance` and ends at `truth`.
fn shares(radiance: &RadianceBuffer, chain: &[(&str, RadianceBuffer)], truth: &Reference) -> Vec<StageError> {
    let whole = |i: usize, c: usize| f64::from(radiance.channels[c][i]) - f64::from(truth.radiance.channels[c][i]);
    let of = |weights: &ReceiverWeights, change: &dyn Fn(usize, usize) -> f64| {
        weights.mean(|i| (0..3).map(|c| change(i, c)).sum::<f64>() / 3.0)
    };
    let noise = |weights: &ReceiverWeights| weights.mean(|i| square(&truth.standard_error, i));
    let squared = |weights: &ReceiverWeights| of(weights, &|i, c| whole(i, c).powi(2)) - noise(weights);
    let by_class: Vec<(String, ReceiverWeights)> = Hider::ALL
        .into_iter()
        .filter_map(|class| {
            let weights = truth.weights.only(|i| truth.hiders.get(i) == Some(&class))?;
            (squared(&weights) > 0.0).then(|| (classes::name(class).to_owned(), weights))
        })
        .collect();
    if squared(&truth.weights) <= 0.0 {
        return Vec::new();
    }
    let before = |place: usize| if place == 0 { radiance } else { &chain[place - 1].1 };
    let stage = |(place, (name, after)): (usize, &(&str, RadianceBuffer))| {
        let is_last = place + 1 == chain.len();
        let change = |i: usize, c: usize| f64::from(before(place).channels[c][i]) - f64::from(after.channels[c][i]);
        let share = |weights: &ReceiverWeights| {
            let noise = if is_last { noise(weights) } else { 0.0 };
            (of(weights, &|i, c| change(i, c) * whole(i, c)) - noise) / squared(weights)
        };
        let noise = if is_last { noise(&truth.weights) } else { 0.0 };
        StageError {
            stage: (*name).to_owned(),
            rms: (of(&truth.weights, &|i, c| change(i, c).powi(2)) - noise).max(0.0).sqrt(),
            share: share(&truth.weights),
            classes: by_class
                .iter()
                .map(|(class, weights)| (class.clone(), share(weights)))
                .collect::<BTreeMap<_, _>>(),
        }
    };
    chain.iter().enumerate().map(stage).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn buffer(values: &[f32]) -> RadianceBuffer {
        RadianceBuffer { channels: std::array::from_fn(|_| values.to_vec()) }
    }

    fn truth(values: &[f32]) -> Reference {
        let weights = Arc::new(ReceiverWeights::equal(values.len()));
        Reference {
            hiders: vec![Hider::Nothing; values.len()].into(),
            ..Reference::exact(buffer(values), 1.0, weights)
        }
    }

    /// Errors 3 and -1: the first change takes 2 and 1 of them, the second what is left.
    #[test]
    fn shares_are_those_of_the_products_and_sum_to_one() {
        let chain = [("first", buffer(&[2.0, -2.0])), (REST, buffer(&[1.0, 0.0]))];
        let found = shares(&buffer(&[4.0, -1.0]), &chain, &truth(&[1.0, 0.0]));
        let expected = [(2.0 * 3.0 - 1.0) / 10.0, (1.0 * 3.0 + 2.0) / 10.0];
        let rms = [(5.0f64 / 2.0).sqrt(), (5.0f64 / 2.0).sqrt()];
        for ((stage, share), rms) in found.iter().zip(expected).zip(rms) {
            assert!((stage.share - share).abs() < 1e-12 && (stage.rms - rms).abs() < 1e-12, "{stage:?}");
            assert_eq!(stage.classes.len(), 1);
        }
        assert_eq!(found.iter().map(|stage| stage.share).sum::<f64>(), 1.0);
    }

    /// Noise of the truth alone is no error, and with an error it takes no share of it.
    #[test]
    fn noise_of_the_truth_is_nobodys_error() {
        let count = 20_000;
        let noise: Vec<f32> = (0..count).map(|i| if i * 7919 % 13 < 6 { 0.2 } else { -0.2 }).collect();
        let noisy = Reference { standard_error: buffer(&vec![0.2; count]), ..truth(&noise) };
        let biased = buffer(&vec![0.5; count]);
        let chain = [("bias", buffer(&vec![0.0; count])), (REST, noisy.radiance.clone())];
        let found = shares(&biased, &chain, &noisy);
        assert!((found[0].share - 1.0).abs() < 0.05 && found[1].share.abs() < 0.05, "{found:?}");
        assert!((found[0].rms - 0.5).abs() < 1e-6 && found[1].rms < 0.02, "{found:?}");
        assert!(shares(&buffer(&vec![0.0; count]), &[(REST, noisy.radiance.clone())], &noisy).is_empty());
    }
}
