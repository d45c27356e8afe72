//! Light from infinitely far, turned into the space that transfer was baked in.

use crate::prt::{bake::arrangement::Arrangement, kernel::dot::LightVectors, prepare::shaped::LightShape};
use glam::{DMat3, Mat3};
use halfshade_scene::{Environment, Frame};
use halfshade_sh::{kernel::LANES, rotation::ShRotation, zonal};
use wide::f32x8;

/// The light of the last frame.
#[derive(Debug)]
pub(crate) struct FrameLight {
    pub(crate) bands: usize,
    shape: LightShape,
    environment: Environment,
    /// The environment's vectors in its own space, which a turn doesn't change.
    projected: [Vec<f64>; 3],
    /// Radiance times steradian, by channel and coefficient, as it falls onto the scene as baked.
    pub(crate) coefficients: [Vec<f32>; 3],
    /// The same, by eights.
    pub(crate) vectors: LightVectors,
    /// Rotation of normals.
    pub(crate) baked_from_world: Mat3,
    /// Clamped cosine over π by band, times the factor of the rotation to an axis.
    pub(crate) cosine: Vec<f32>,
}

impl FrameLight {
    /// The light of `environment`, not turned.
    pub(crate) fn new(shape: LightShape, bands: usize, environment: &Environment) -> Self {
        let projected = shape.projected(bands, environment);
        let mut light = Self {
            bands,
            shape,
            environment: environment.clone(),
            projected,
            coefficients: Default::default(),
            vectors: LightVectors::default(),
            baked_from_world: Mat3::IDENTITY,
            cosine: zonal::reflectance(bands).into_iter().map(|value| value as f32).collect(),
        };
        light.turn(DMat3::IDENTITY);
        light
    }

    /// Makes it the light of a frame of the scene that `arrangement` is of.
    pub(crate) fn set(&mut self, frame: &Frame<'_>, arrangement: &Arrangement) {
        if !self.environment.is_same_as(&frame.scene.environment) {
            self.environment = frame.scene.environment.clone();
            self.projected = self.shape.projected(self.bands, &self.environment);
        }
        let baked_from_world = arrangement.baked_from_world(&frame.world_from_object);
        self.baked_from_world = baked_from_world.as_mat3();
        self.turn(baked_from_world * DMat3::from_quat(frame.world_from_environment.as_dquat().normalize()));
    }

    fn turn(&mut self, baked_from_environment: DMat3) {
        // Rows of the rotation are the columns of its transpose.
        let rotation = ShRotation::new(self.bands, &baked_from_environment.transpose().to_cols_array_2d());
        for channel in 0..3 {
            let turned = rotation.apply(&self.projected[channel]);
            let turned: Vec<f32> = turned.into_iter().map(|value| value as f32).collect();
            let padded: Vec<f32> = turned.iter().copied().chain([0.0; LANES - 1]).collect();
            let eights = padded.as_chunks::<LANES>().0.iter().map(|&eight| f32x8::from(eight));
            self.vectors[channel] = Default::default();
            self.vectors[channel].iter_mut().zip(eights).for_each(|(place, eight)| *place = eight);
            self.coefficients[channel] = turned;
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let projected: usize = self.projected.iter().map(|channel| size_of_val(channel.as_slice())).sum();
        let turned: usize = self.coefficients.iter().map(|channel| size_of_val(channel.as_slice())).sum();
        projected + turned + size_of_val(&self.vectors) + size_of_val(self.cosine.as_slice())
    }
}
