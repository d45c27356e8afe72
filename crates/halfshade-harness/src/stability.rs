//! How a strategy behaves at an extreme: figures that are to stay within bounds, whatever the scene.
//!
//! With L a strategy's radiance, T the truth's and U what is there with every blocker taken away, Ū the mean of U by weight, w a
//! receiver's weight:
//!
//! - `worst_error`: the largest |L − T| of any value, over Ū;
//! - `negative_share`: the share of the values below 0, by weight;
//! - `energy_gained`: `Σ w max(0, L − max(U, T)) / Σ w U`, each the mean over channels. Blockers only take light away, and what they
//!   reflect is in T: what is above both came from nowhere;
//! - `jump`: the largest `|L_i − L_j| − |T_i − T_j|` of any channel between neighbours i and j, over Ū: an edge that isn't there. Vertices
//!   are neighbours along the edges of a mesh, pixels side by side and one above the other.
//!
//! All contain the truth's noise; bounds are to lie well above it.

use crate::{errors::Reference, metrics::Metrics};
use halfshade_scene::{RadianceBuffer, Scene};
use serde::{Deserialize, Serialize};

/// The figures, or bounds on them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StabilityFigures {
    /// Largest error of any value, as a fraction of the mean unshadowed radiance.
    pub worst_error: f64,
    /// Share of the values below 0.
    pub negative_share: f64,
    /// Radiance that nothing sent, as a fraction of all unshadowed radiance.
    pub energy_gained: f64,
    /// Largest jump between neighbours beyond the truth's own, as a fraction of the mean unshadowed radiance.
    pub jump: f64,
}

/// Findings of a strategy at an extreme.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// How many values are not finite.
    pub not_finite: usize,
    /// Everything else; nothing if any value isn't finite, or there is no light.
    pub figures: Option<StabilityFigures>,
}

impl StabilityFigures {
    /// By name, in the order of tables.
    pub fn all(self) -> [(&'static str, f64); 4] {
        let Self { worst_error, negative_share, energy_gained, jump } = self;
        [
            ("worst_error", worst_error),
            ("negative_share", negative_share),
            ("energy_gained", energy_gained),
            ("jump", jump),
        ]
    }

    /// Figures of `radiance`, whose errors against `reference` are `metrics`. `None` without light.
    pub(crate) fn of(
        radiance: &RadianceBuffer,
        reference: &Reference,
        metrics: &Metrics,
        neighbours: &[[u32; 2]],
    ) -> Option<Self> {
        metrics.rel_rmse?;
        let unit = reference.unshadowed_mean;
        let truth = &reference.radiance;
        let mean = |values: &RadianceBuffer, i: usize| {
            values.channels.iter().map(|channel| f64::from(channel[i])).sum::<f64>() / 3.0
        };
        let unshadowed = |i: usize| reference.unshadowed.get(i).map_or(unit, |value| f64::from(*value));
        let gained = |i: usize| (mean(radiance, i) - unshadowed(i).max(mean(truth, i))).max(0.0);
        let step =
            |channel: &[f32], [i, j]: [u32; 2]| (f64::from(channel[i as usize]) - f64::from(channel[j as usize])).abs();
        let excess = |pair: [u32; 2]| {
            let channels = radiance.channels.iter().zip(&truth.channels);
            channels.map(|(own, true_one)| step(own, pair) - step(true_one, pair)).fold(0.0, f64::max)
        };
        Some(Self {
            worst_error: metrics.max / unit,
            negative_share: metrics.negative.unwrap_or(0.0),
            energy_gained: reference.weights.mean(gained) / unit,
            jump: neighbours.iter().map(|pair| excess(*pair)).fold(0.0, f64::max) / unit,
        })
    }
}

/// Pairs of vertex receivers of a scene that an edge of a mesh joins.
pub(crate) fn joined_vertices(scene: &Scene) -> Vec<[u32; 2]> {
    let mut first = 0;
    let mut pairs = Vec::new();
    for object in &scene.objects {
        let edges = object.mesh.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        pairs.extend(edges.map(|[a, b]| [first + a.min(b), first + a.max(b)]));
        first += object.mesh.positions.len() as u32;
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{metrics::compare, weights::ReceiverWeights};
    use glam::Vec3;
    use halfshade_scene::{Environment, Mesh, Object};
    use std::sync::Arc;

    fn buffer(values: [f32; 4]) -> RadianceBuffer {
        RadianceBuffer { channels: std::array::from_fn(|_| values.to_vec()) }
    }

    /// Unshadowed radiance 2, of which the truth lets half through on two of four receivers.
    #[test]
    fn figures_worked_out_by_hand() {
        let weights = Arc::new(ReceiverWeights::equal(4));
        let reference =
            Reference { unshadowed: [2.0; 4].into(), ..Reference::exact(buffer([2.0, 1.0, 1.0, 2.0]), 2.0, weights) };
        let found = |values: [f32; 4]| {
            let radiance = buffer(values);
            let metrics = compare(&radiance, &reference).unwrap();
            StabilityFigures::of(&radiance, &reference, &metrics, &[[0, 1], [1, 2], [2, 3]]).unwrap()
        };
        let none = StabilityFigures { worst_error: 0.0, negative_share: 0.0, energy_gained: 0.0, jump: 0.0 };
        assert_eq!(found([2.0, 1.0, 1.0, 2.0]), none);
        // A smooth answer jumps nowhere.
        assert_eq!(found([1.5; 4]), StabilityFigures { worst_error: 0.25, ..none });
        // 3 where there can't be more than 2; from -1 to 1 where the truth stays.
        let wild = found([3.0, -1.0, 1.0, 2.0]);
        assert_eq!(wild, StabilityFigures { worst_error: 1.0, negative_share: 0.25, energy_gained: 0.125, jump: 1.5 });
        let dark = Reference { unshadowed_mean: 0.0, ..reference.clone() };
        let metrics = compare(&buffer([0.0; 4]), &dark).unwrap();
        assert!(StabilityFigures::of(&buffer([0.0; 4]), &dark, &metrics, &[]).is_none());
    }

    #[test]
    fn edges_join_vertices_of_one_object_once() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO; 4],
            normals: vec![Vec3::Y; 4],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
            ..Mesh::default()
        };
        let objects = ["a", "b"].map(|name| Object::new(name, mesh.clone())).to_vec();
        let scene = Scene::at_rest("two", objects, Environment::constant(Vec3::ONE));
        let one = [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]];
        assert_eq!(joined_vertices(&scene), [one, one.map(|pair| pair.map(|i| i + 4))].concat());
    }
}
