//! Compressed transfer on the device: weights and where receivers lie between them stay there, products with light go up.
//!
//! A receiver on no triangle gets a product of its own: light times its vector.

use super::too_large::told;
use crate::{
    GpuError,
    kernels::PRT_CLUSTERS,
    receivers::KernelSpace,
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use glam::DMat3;
use halfshade_scene::{Frame, Receivers};
use halfshade_strategies::prt::{
    BakedScene,
    arrays::{ClusterArrays, FrameArrays, Place},
};
use halfshade_strategy::{Baked, Detail, Footprint, Prepared, StrategyError};

/// Settings of a scene, as the shader reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/decode.wgsl`")]
pub struct ClusterUniforms {
    pub components: u32,
    pub padding: [u32; 3],
}

/// A receiver between vertices.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/decode.wgsl`")]
pub struct ClusterBetween {
    pub rows: [u32; 3],
    pub padding: u32,
    pub clusters: [u32; 3],
    pub more_padding: u32,
    pub weights: [f32; 3],
    pub most_padding: u32,
}

pub(super) struct ClusteredOnGpu {
    baked: BakedScene,
    runner: Runner,
    /// Vectors of receivers that lie on no triangle, times which light their products are.
    open: Vec<Vec<f32>>,
    products: Vec<[f32; 4]>,
}

impl ClusteredOnGpu {
    pub(super) fn new(bench: &Bench, baked: BakedScene) -> Result<Self, GpuError> {
        let mut runner = Runner::new(bench, &PRT_CLUSTERS, None, &[], size_of::<ClusterUniforms>())?;
        let ClusterArrays { components, weights, .. } = arrays(&baked);
        runner.write_uniforms(&ClusterUniforms { components: components as u32, padding: [0; 3] });
        // Weights of receivers in the open are 0.
        runner.write(1, &[weights, &vec![0.0; components.max(1)]].concat())?;
        Ok(Self { baked, runner, open: Vec::new(), products: Vec::new() })
    }

    /// Where each receiver lies; vectors of those in the open are kept.
    fn points(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Vec<ClusterBetween> {
        let ClusterArrays { components, of_row, weights, products } = arrays(&self.baked);
        self.open.clear();
        let point = |(i, place)| {
            let mut point = ClusterBetween::default();
            match place {
                Place::Dark => {}
                Place::Between(between) => {
                    for (k, (row, weight)) in between.into_iter().enumerate() {
                        point.rows[k] = (row * components) as u32;
                        point.clusters[k] = u32::from(of_row[row]) * (components + 1) as u32;
                        point.weights[k] = weight;
                    }
                }
                Place::Open => {
                    point.rows[0] = weights.len() as u32;
                    point.clusters[0] = (products + self.open.len()) as u32;
                    point.weights[0] = 1.0;
                    self.open.push(self.baked.open_vector(frame, receivers.normal_at(i)));
                }
            }
            point
        };
        self.baked.places(receivers).enumerate().map(point).collect()
    }

    /// Products of a frame: those of all clusters, those of receivers in the open, and zeros that may be read past the last.
    fn set_products(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        let components = arrays(&self.baked).components;
        let FrameArrays { light, products } = self.baked.frame_arrays(frame)?;
        let product = |vector: &Vec<f32>| {
            let channel = |channel: usize| vector.iter().zip(&light[channel]).map(|(t, l)| t * l).sum();
            [channel(0), channel(1), channel(2), 0.0]
        };
        self.products.clear();
        self.products.extend_from_slice(products);
        self.products.extend(self.open.iter().map(product));
        self.products.extend(std::iter::repeat_n([0.0; 4], components.max(1)));
        Ok(())
    }
}

/// The compressed table: nothing else is baked for this.
fn arrays(baked: &BakedScene) -> ClusterArrays<'_> {
    baked.scene_arrays().clusters.unwrap_or_default()
}

impl Baked for ClusteredOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint
            .parts
            .extend([("receivers on the device", receivers), ("weights and products on the device", others)]);
        footprint
    }

    fn details(&self) -> Vec<Detail> {
        self.baked.details()
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        let points = self.points(frame, receivers);
        self.runner.write(2, &points).map_err(told)?;
        Ok(self.runner.place_receivers(frame, receivers, &|i| i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.set_products(frame)?;
        self.runner.write(3, &self.products).map_err(told)?;
        let places = frame.world_from_object.iter().map(|pose| pose.translation.as_dvec3());
        self.runner.place_objects(frame, &KernelSpace::of_points(places, DMat3::IDENTITY))?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
