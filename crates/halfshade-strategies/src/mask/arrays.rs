//! Settings, scene and frame as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::kernel::boxes::PlacedBox;
pub use crate::shared::{
    blockers::BlockingSphere,
    placed_lamps::{Lamp, LampPlace},
};

use super::{BakedScene, kernel::directions::DirectionSet, shade::GlossTables};
use crate::shared::irradiance::Irradiance;
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::{Frame, Receivers, spheres::AdjustRule};
use halfshade_strategy::StrategyError;
use std::sync::Arc;
use wide::f32x8;

/// Numbers that stay from frame to frame.
#[derive(Debug, Clone, Copy)]
pub struct SceneArrays {
    /// Treatment of spheres that cut a receiver's tangent plane.
    pub rule: AdjustRule,
    /// Width of an edge in radii of a direction's cell.
    pub edge: f32,
    /// Cells of the grid of normals from its centre to its side; 0: there is one set of directions.
    pub normal_cells: usize,
    /// Cells along the side of the grid of directions that meshes hide from themselves; 0: nothing is known of any.
    pub own_side: usize,
}

/// Everything that a frame has.
#[derive(Debug)]
pub struct FrameArrays<'a> {
    /// Light space is `rotation · (point - origin)`.
    pub rotation: DMat3,
    /// Its origin in the world.
    pub origin: DVec3,
    /// Spheres in light space.
    pub spheres: &'a [BlockingSphere],
    /// Boxes in light space.
    pub boxes: &'a [PlacedBox],
    /// Lamps in light space.
    pub lamps: &'a [Lamp],
    /// Irradiance of everything but lamps.
    pub rest: &'a Irradiance,
    /// How often that has become another one.
    pub light_changes: u32,
    /// Directions into each lamp.
    pub lamp_directions: usize,
}

/// Directions that receivers of about the same normal look into.
#[derive(Debug, Clone)]
pub struct SetArrays {
    /// Mean of the sharpness.
    pub mean_sharpness: f32,
    /// Unit direction and sharpness of each, 0 for what fills up, and weights by channel.
    pub directions: Vec<([f32; 4], [f32; 3])>,
}

/// A receiver between vertices of its mesh.
#[derive(Debug, Clone, Copy)]
pub struct OwnPoint {
    /// The words of [`BakedScene::own_words`] at which those of each vertex begin.
    pub words: [u32; 3],
    /// Weights of the vertices.
    pub weights: [f32; 3],
    /// Whether nothing is in the way of any of them.
    pub is_all_open: bool,
}

impl BakedScene {
    /// Numbers that stay from frame to frame.
    pub fn scene_arrays(&self) -> SceneArrays {
        SceneArrays {
            rule: self.settings.rule.into(),
            edge: self.drawing.edge,
            normal_cells: self.drawing.normals,
            own_side: self.own.iter().flatten().next().map_or(0, |own| own.cells.side),
        }
    }

    /// Brings everything up to a frame, and gives it.
    pub fn frame_arrays(&mut self, frame: &Frame<'_>) -> Result<FrameArrays<'_>, StrategyError> {
        self.prepare_frame(frame)?;
        Ok(FrameArrays {
            rotation: self.frame.space.rotation,
            origin: self.frame.space.origin,
            spheres: &self.frame.spheres,
            boxes: &self.frame.boxes,
            lamps: &self.frame.lamps,
            rest: &self.light.rest,
            light_changes: self.light_changes,
            lamp_directions: self.spiral.count,
        })
    }

    /// The directions of every node of the grid of normals.
    pub fn sets(&self) -> Vec<SetArrays> {
        let channels = self.sets.channels;
        let of = |set: &DirectionSet| {
            let weights =
                |k: usize, lane: usize| std::array::from_fn(|c| lane_of(&set.weights[c.min(channels - 1)][k], lane));
            let directions = set.directions.iter().enumerate().flat_map(|(k, eight)| {
                let direction = move |lane: usize| eight.direction.each_ref().map(|axis| lane_of(axis, lane));
                (0..8).map(move |lane| {
                    let [x, y, z] = direction(lane);
                    ([x, y, z, lane_of(&eight.sharpness, lane)], weights(k, lane))
                })
            });
            SetArrays { mean_sharpness: set.mean_sharpness, directions: directions.collect() }
        };
        self.sets.sets.iter().map(of).collect()
    }

    /// Places on a lamp, of which there are [`FrameArrays::lamp_directions`], and others that fill up: part within, cosine and
    /// sine of the turn.
    pub fn lamp_places(&self) -> Vec<[f32; 3]> {
        let spiral = &self.spiral;
        let eight = spiral.within.iter().zip(&spiral.turn);
        eight
            .flat_map(|(within, [cos, sin])| (0..8).map(move |lane| [within, cos, sin].map(|of| lane_of(of, lane))))
            .collect()
    }

    /// Directions along every lobe, a multiple of 16: -log of the part of the lobe without, cosine and sine of the turn. None
    /// where nothing is glossy.
    pub fn lobe_places(&self) -> Vec<[f32; 3]> {
        let Some(GlossTables { spiral, .. }) = &self.gloss else { return Vec::new() };
        let eight = spiral.logs.iter().zip(&spiral.turn);
        eight
            .flat_map(|(log, [cos, sin])| (0..8).map(move |lane| [log, cos, sin].map(|of| lane_of(of, lane))))
            .collect()
    }

    /// Light over lobes, level by level: cells of its grid from the centre to the side, and means at the nodes. None under constant
    /// light.
    pub fn lobe_levels(&self) -> impl Iterator<Item = (usize, &[Vec3])> {
        let levels = self.gloss.iter().flat_map(|gloss| &gloss.light.levels);
        levels.map(|level| (level.grid.cells(), level.means.as_slice()))
    }

    /// Words of the cells that are open, mesh after mesh.
    pub fn own_words(&self) -> Vec<u32> {
        let meshes = self.own.iter().enumerate().filter(|(object, _)| self.first_of_mesh(*object) == *object);
        meshes.flat_map(|(_, own)| own.iter().flat_map(|own| own.cells.words.iter().copied())).collect()
    }

    /// Places of receivers in the words of their own meshes; `None` where nothing is known.
    pub fn own_points(&self, receivers: Receivers<'_>) -> Vec<Option<OwnPoint>> {
        let mut first_words = Vec::with_capacity(self.own.len());
        let mut next = 0;
        for (object, own) in self.own.iter().enumerate() {
            let first = self.first_of_mesh(object);
            let own_first = if first < object { first_words[first] } else { next };
            first_words.push(own_first);
            if first == object {
                next += own.as_ref().map_or(0, |own| own.cells.words.len() as u32);
            }
        }
        let point = |i: usize| {
            let object = receivers.object[i] as usize;
            let own = self.own.get(object)?.as_ref()?;
            let weights = receivers.surface[i].weights_in_front(&own.mesh)?;
            let per_vertex = super::kernel::own::words_of(own.cells.side) as u32;
            let mut point = OwnPoint { words: [first_words[object]; 3], weights: [0.0; 3], is_all_open: true };
            for (k, (vertex, weight)) in weights.parts().enumerate() {
                point.words[k] += per_vertex * vertex as u32;
                point.weights[k] = weight;
                point.is_all_open &= own.cells.is_all_open(vertex);
            }
            Some(point)
        };
        (0..receivers.len()).map(point).collect()
    }

    /// The first object that has the mesh of this one.
    fn first_of_mesh(&self, object: usize) -> usize {
        let same = |other: &usize| match (&self.own[*other], &self.own[object]) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        (0..object).find(same).unwrap_or(object)
    }
}

fn lane_of(values: &f32x8, lane: usize) -> f32 {
    values.to_array()[lane]
}
