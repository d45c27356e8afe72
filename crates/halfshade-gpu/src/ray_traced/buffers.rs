//! The buffers of a frame's rays, for callers of single functions.

use super::{
    frame::{FrameRows, FrameUniforms, Light, lasting_rows},
    meshes::{DeviceTriangle, Meshes, space_of},
    tables::Tables,
};
use crate::{GpuError, hierarchy::Node, receivers::KernelSpace, rows::Row};
use glam::DVec3;
use halfshade_scene::Frame;
use halfshade_strategies::ray_traced::arrays::{LightSampler, SampleArrays};
use halfshade_strategy::Params;

/// Buffers that the functions of `ray_traced` read of a frame.
#[derive(Debug)]
pub struct RayBuffers {
    /// Settings.
    pub uniforms: FrameUniforms,
    /// Hierarchies.
    pub nodes: Vec<Node>,
    /// Triangles of meshes.
    pub triangles: Vec<DeviceTriangle>,
    /// All else.
    pub rows: Vec<Row>,
    tables: Tables,
    space: KernelSpace,
}

impl RayBuffers {
    /// With the settings of a strategy with `params`.
    pub fn new(frame: &Frame<'_>, params: &Params) -> Result<Self, GpuError> {
        let tables = Tables::new(frame.scene);
        let mut meshes = Meshes::of(frame, &tables.holes);
        let space = space_of(frame, &meshes);
        let samples = SampleArrays::new(params);
        let sampler = LightSampler::new(frame, None);
        let sampler = if samples.is_product { sampler.with_tree() } else { sampler };
        let irradiance = samples.irradiance(frame.scene);
        let light = Light { sampler: &sampler, irradiance: irradiance.as_ref() };
        let FrameRows { mut rows, uniforms } = FrameRows::new(frame, &mut meshes, &space, &tables, &light, &samples)?;
        let first = rows.len();
        rows.extend(lasting_rows(first, &tables, &light));
        let Meshes { nodes, triangles, .. } = meshes;
        Ok(Self { uniforms, nodes, triangles, rows, tables, space })
    }

    /// A point of the world in the space of the kernels.
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.space.place(point)
    }

    /// The number of the row at which the holes of a triangle begin; 0 for a whole one.
    pub fn holes(&self, object: usize, triangle: usize) -> u32 {
        self.tables.holes[object].get(triangle).copied().unwrap_or(0)
    }
}
