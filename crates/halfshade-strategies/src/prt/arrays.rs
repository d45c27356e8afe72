//! Transfer and light as plain arrays, for kernels that run elsewhere than on the processor.

pub use super::shade::place::Place;

use super::{BakedScene, bake::hemisphere::open_transfer};
use glam::{DVec3, Vec3};
use halfshade_scene::{Frame, Receivers};
use halfshade_strategy::StrategyError;

/// Everything that holds for all frames of a scene.
#[derive(Debug, Clone, Copy)]
pub struct SceneArrays<'a> {
    /// Bands of all vectors.
    pub bands: usize,
    /// Vectors per row: 1, or 3 for red, green and blue.
    pub channels: usize,
    /// Rows of as many vectors, each of bands² numbers: the vertices of all objects, then the backs of some. 1/π is in them, the
    /// albedo of what they belong to isn't.
    pub rows: &'a [f32],
    /// Stored instead of rows, where they are compressed.
    pub clusters: Option<ClusterArrays<'a>>,
}

/// A compressed table: a receiver at row i is the product of light with the mean of its cluster, and the weighted products with
/// its axes.
#[derive(Debug, Clone, Copy, Default)]
pub struct ClusterArrays<'a> {
    /// Weights of a row.
    pub components: usize,
    /// Number of the cluster of each row.
    pub of_row: &'a [u16],
    /// Weights of each row.
    pub weights: &'a [f32],
    /// Products of a frame: one more than `components` for each cluster.
    pub products: usize,
}

/// Local lights of a scene that has any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalLights {
    /// Whether they are known at points of a grid alone.
    pub is_between_points: bool,
    /// Whether a window lessens their bands.
    pub is_windowed: bool,
}

/// Light of a frame.
#[derive(Debug, Clone, Copy)]
pub struct FrameArrays<'a> {
    /// Radiance times steradian, by channel and coefficient, in the space of the rows.
    pub light: &'a [Vec<f32>; 3],
    /// Light times the means and axes of clusters: red, green, blue, and 0.
    pub products: &'a [[f32; 4]],
}

impl BakedScene {
    /// Transfer of the scene.
    pub fn scene_arrays(&self) -> SceneArrays<'_> {
        let transfer = &self.transfer;
        let clusters = transfer.clusters.as_ref().map(|clusters| ClusterArrays {
            components: clusters.components,
            of_row: &clusters.of_row,
            weights: &clusters.weights,
            products: self.product_count(),
        });
        SceneArrays { bands: transfer.bands, channels: transfer.channels, rows: transfer.rows(), clusters }
    }

    /// Local lights, if the scene has any.
    pub fn local_lights(&self) -> Option<LocalLights> {
        let lamps = self.lamps.as_ref()?;
        Some(LocalLights { is_between_points: lamps.point_count().is_some(), is_windowed: lamps.is_windowed() })
    }

    /// Brings the light up to a frame, and gives it.
    ///
    /// # Errors
    /// Why the frame can't be shaded with what was baked.
    pub fn frame_arrays(&mut self, frame: &Frame<'_>) -> Result<FrameArrays<'_>, StrategyError> {
        self.prepare_frame(frame)?;
        Ok(FrameArrays { light: &self.light.coefficients, products: &self.products })
    }

    /// Transfer of a receiver with this normal in the world of a frame, if nothing hid any light.
    pub fn open_vector(&self, frame: &Frame<'_>, normal: Vec3) -> Vec<f32> {
        let baked_from_world = self.arrangement.baked_from_world(&frame.world_from_object);
        let axis = (baked_from_world * normal.as_dvec3()).normalize_or(DVec3::Y);
        open_transfer(self.transfer.bands, axis).into_iter().map(|value| value as f32).collect()
    }

    /// Rows between which each receiver lies.
    pub fn places(&self, receivers: Receivers<'_>) -> impl Iterator<Item = Place> {
        (0..receivers.len()).map(move |i| Place::of(&self.transfer, &receivers, i))
    }
}
