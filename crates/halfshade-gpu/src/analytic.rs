//! `analytic` on the device: the table of the light stays there, spheres and lamps go up.

use crate::{
    kernels::ANALYTIC,
    pipeline::flag,
    placed::{Placed, constant_or_cells, node_rows},
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use halfshade_scene::{Frame, Progress, Receivers, Scene};
use halfshade_strategies::{Analytic, analytic::BakedScene};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};

/// Places of the kernel's buffers in group 1.
const ROWS: usize = 1;
const TABLES: usize = 2;

/// [`Analytic`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct AnalyticOnGpu {
    bench: Bench,
}

/// Settings of a frame, as the shader reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `analytic/frame.wgsl`")]
pub struct FrameUniforms {
    pub constant: [f32; 4],
    pub grid_cells: f32,
    pub sphere_count: u32,
    pub lamp_count: u32,
    pub padding: u32,
}

struct BakedOnGpu {
    baked: BakedScene,
    runner: Runner,
    /// Changes of the light for which the table is on the device.
    table_of: Option<u32>,
}

impl AnalyticOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for AnalyticOnGpu {
    fn info(&self) -> Info {
        Analytic.info()
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let baked = Analytic::bake_scene(scene, params);
        let constants = [("SEES_OWN", flag(baked.sees_own()))];
        let runner = Runner::new(&self.bench, &ANALYTIC, None, &constants, size_of::<FrameUniforms>())?;
        Ok(Box::new(BakedOnGpu { baked, runner, table_of: None }))
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint.parts.extend([("receivers on the device", receivers), ("table and frame on the device", others)]);
        footprint
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        Ok(self.runner.place_receivers(frame, receivers, &|_| 0)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let arrays = self.baked.frame_arrays(frame)?;
        let placed = Placed { spheres: arrays.spheres, lamps: arrays.lamps };
        let space = placed.space(arrays.rotation, arrays.origin, std::iter::empty());
        let scale = space.scale as f32;
        let rows: Vec<[f32; 4]> = placed.sphere_rows(scale).chain(placed.lamp_rows(scale)).collect();
        let (constant, grid_cells) = constant_or_cells(arrays.rest);
        let uniforms = FrameUniforms {
            constant,
            grid_cells,
            sphere_count: arrays.spheres.len() as u32,
            lamp_count: arrays.lamps.len() as u32,
            padding: 0,
        };
        if self.table_of != Some(arrays.light_changes) {
            self.runner.write(TABLES, &node_rows(arrays.rest))?;
            self.table_of = Some(arrays.light_changes);
        }
        self.runner.write_uniforms(&uniforms);
        self.runner.write(ROWS, &rows)?;
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
