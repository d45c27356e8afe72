//! How much each receiver counts.
//!
//! A vertex counts by the area around it, a third of every triangle that it is a corner of, in world space at the frame
//! that is scored: `w_v = Σ over triangles at v of |(b − a) × (c − a)| / 6`, in square metres. Vertices that many small
//! triangles share, or that lie close together where a mesh is fine, then count no more than the surface they stand for;
//! those of no triangle count nothing. Pixels count alike, as do vertices with `weights = "equal"`, as in papers that
//! average over vertices, and those of scenes without any area.

use crate::ReceiverKind;
use glam::DVec3;
use halfshade_scene::{Frame, ReceiverBuffer};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Rule for the weights of receivers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Weighting {
    /// Vertices by the area around them.
    Area,
    /// All alike.
    Equal,
}

impl fmt::Display for Weighting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Area => "area",
            Self::Equal => "equal",
        })
    }
}

/// A weight for each receiver; finite, not negative, not all zero unless there are none.
#[derive(Debug, Clone, PartialEq)]
pub struct ReceiverWeights {
    weighting: Weighting,
    values: Vec<f64>,
    total: f64,
}

impl ReceiverWeights {
    /// All alike: 1 each.
    pub fn equal(count: usize) -> Self {
        Self { weighting: Weighting::Equal, values: vec![1.0; count], total: count as f64 }
    }

    /// Those of receivers of a `kind` in `frame`, vertices by the rule `weighting`.
    pub(crate) fn of_kind(
        kind: ReceiverKind,
        weighting: Weighting,
        frame: &Frame<'_>,
        receivers: &ReceiverBuffer,
    ) -> Self {
        match (kind, weighting) {
            (ReceiverKind::Vertices, Weighting::Area) => Self::by_area(frame, receivers),
            _ => Self::equal(receivers.len()),
        }
    }

    /// Those of `vertices`, which are [`ReceiverBuffer::vertices`] of `frame`, by the area around them.
    pub fn by_area(frame: &Frame<'_>, vertices: &ReceiverBuffer) -> Self {
        let view = vertices.view();
        let mut values = vec![0.0; view.len()];
        let mut first = 0;
        for object in &frame.scene.objects {
            let count = object.mesh.positions.len();
            for triangle in &object.mesh.triangles {
                let places = triangle.map(|vertex| first + vertex as usize);
                if places.iter().any(|&place| place >= (first + count).min(values.len())) {
                    continue;
                }
                let [a, b, c] = places.map(|place| view.position_at(place).as_dvec3());
                let area = double_area(a, b, c) / 2.0;
                if area.is_finite() {
                    places.iter().for_each(|&place| values[place] += area / 3.0);
                }
            }
            first += count;
        }
        Self::of(Weighting::Area, values).unwrap_or_else(|| Self::equal(view.len()))
    }

    /// `None` where nothing would count.
    pub(crate) fn of(weighting: Weighting, values: Vec<f64>) -> Option<Self> {
        let total: f64 = values.iter().sum();
        (total > 0.0 && total.is_finite()).then_some(Self { weighting, values, total })
    }

    /// The same where `counts`, 0 elsewhere; `None` where nothing would count.
    pub fn only(&self, counts: impl Fn(usize) -> bool) -> Option<Self> {
        let values = self.values.iter().enumerate().map(|(i, weight)| if counts(i) { *weight } else { 0.0 });
        Self::of(self.weighting, values.collect())
    }

    /// Rule for the weights of receivers.
    pub fn weighting(&self) -> Weighting {
        self.weighting
    }

    /// One for each receiver.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Their sum.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The mean of a figure of each receiver; 0 without any.
    pub fn mean(&self, figure: impl Fn(usize) -> f64) -> f64 {
        let counted = self.values.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        let sum: f64 = counted.map(|(i, weight)| weight * figure(i)).sum();
        if self.total > 0.0 { sum / self.total } else { 0.0 }
    }
}

fn double_area(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halfshade_scene::{Environment, Mesh, Object, Pose, Scene};

    fn scene(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, scale: f32) -> Scene {
        let mesh = Mesh { normals: vec![Vec3::Y; positions.len()], positions, triangles, ..Mesh::default() };
        let object = Object::new("object", mesh).pose(Pose { scale, ..Pose::IDENTITY });
        Scene::at_rest("test", vec![object], Environment::constant(Vec3::ONE))
    }

    fn weights(scene: &Scene) -> ReceiverWeights {
        let frame = scene.frame(0);
        ReceiverWeights::by_area(&frame, &ReceiverBuffer::vertices(&frame))
    }

    #[test]
    fn vertices_share_the_triangles_they_are_corners_of_in_world_space() {
        // A triangle of area 2 and one of area 1 along an edge, and a vertex of neither; at twice the size.
        let positions = vec![Vec3::ZERO, 2.0 * Vec3::X, 2.0 * Vec3::Z, -Vec3::X, 9.0 * Vec3::ONE];
        let found = weights(&scene(positions, vec![[0, 2, 1], [0, 3, 2]], 2.0));
        let expected = [4.0, 8.0 / 3.0, 4.0, 4.0 / 3.0, 0.0];
        assert!(found.values().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!((found.total(), found.weighting()), (12.0, Weighting::Area));
        assert!((found.mean(|i| i as f64) - (8.0 / 3.0 + 8.0 + 4.0) / 12.0).abs() < 1e-12);
        let part = found.only(|i| i == 1).unwrap();
        assert!((part.mean(|i| i as f64) - 1.0).abs() < 1e-12 && found.only(|i| i == 4).is_none());
    }

    #[test]
    fn a_scene_without_area_counts_all_alike() {
        let line = scene(vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], vec![[0, 1, 2]], 1.0);
        assert_eq!(weights(&line), ReceiverWeights::equal(3));
        assert_eq!(weights(&scene(vec![Vec3::ZERO, Vec3::NAN, Vec3::X], vec![[0, 1, 2]], 1.0)).total(), 3.0);
        assert_eq!(weights(&scene(Vec::new(), Vec::new(), 1.0)).mean(|_| 1.0), 0.0);
    }
}
