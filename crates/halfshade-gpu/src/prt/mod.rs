//! `prt` on the device: vectors and where receivers lie between them stay there, light goes up.
//!
//! A receiver on no triangle gets a row of its own when it is placed, of the light that an open sky would send it: kernels know no
//! spherical harmonics.

mod clusters;
mod too_large;

pub use clusters::{ClusterBetween, ClusterUniforms};

use crate::{
    kernels::PRT,
    receivers::KernelSpace,
    rows::in_fours,
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use clusters::ClusteredOnGpu;
use glam::DMat3;
use halfshade_scene::{Cache, Frame, Progress, Receivers, Scene};
use halfshade_strategies::{
    Prt,
    prt::{
        BakedScene,
        arrays::{Place, SceneArrays},
    },
};
use halfshade_strategy::{Baked, Detail, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use too_large::told;

/// Rows of four of the longest vector.
const MOST_PARTS: usize = 16;

/// [`Prt`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct PrtOnGpu {
    bench: Bench,
    strategy: Prt,
}

/// Light of a frame, as the shader reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/dot.wgsl`")]
pub struct FrameUniforms {
    pub light: [[[f32; 4]; MOST_PARTS]; 3],
}

/// A receiver between vertices.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/dot.wgsl`")]
pub struct Between {
    pub rows: [u32; 3],
    pub padding: u32,
    pub weights: [f32; 3],
    pub more_padding: u32,
}

struct BakedOnGpu {
    baked: BakedScene,
    runner: Runner,
}

impl PrtOnGpu {
    /// Keeps what takes rays in `cache`.
    pub(crate) fn new(bench: Bench, cache: Cache) -> Self {
        Self { bench, strategy: Prt::new(cache) }
    }
}

impl Strategy for PrtOnGpu {
    fn info(&self) -> Info {
        self.strategy.info()
    }

    fn needs_spheres(&self) -> bool {
        self.strategy.needs_spheres()
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let baked = self.strategy.bake_scene(scene, params, progress)?;
        if baked.has_movers() {
            let reason = "volumes of light have no kernel on the graphics device; take device `cpu`";
            return Err(StrategyError::Unsupported(reason.into()));
        }
        let SceneArrays { bands, channels, clusters, .. } = baked.scene_arrays();
        if clusters.is_some() {
            return Ok(Box::new(ClusteredOnGpu::new(&self.bench, baked)?));
        }
        let constants = [("PARTS", parts(bands) as f64), ("CHANNELS", channels as f64)];
        let runner = Runner::new(&self.bench, &PRT, None, &constants, size_of::<FrameUniforms>())?;
        Ok(Box::new(BakedOnGpu { baked, runner }))
    }
}

/// Rows of four that a vector takes.
fn parts(bands: usize) -> usize {
    (bands * bands).div_ceil(4)
}

impl FrameUniforms {
    /// Light by channel and coefficient.
    pub fn new(light: &[Vec<f32>; 3]) -> Self {
        let mut uniforms = Self::zeroed();
        for (places, channel) in uniforms.light.iter_mut().zip(light) {
            places.iter_mut().zip(in_fours(channel)).for_each(|(place, four)| *place = four);
        }
        uniforms
    }
}

impl BakedOnGpu {
    /// Rows of the table and of those receivers that lie on no triangle, and where each receiver lies between them.
    fn rows(&self, frame: &Frame<'_>, receivers: Receivers<'_>) -> (Vec<[f32; 4]>, Vec<Between>) {
        let SceneArrays { bands, channels, rows, .. } = self.baked.scene_arrays();
        let per_row = channels * parts(bands);
        let mut fours: Vec<[f32; 4]> = rows.chunks_exact(bands * bands).flat_map(in_fours).collect();
        let mut points = Vec::with_capacity(receivers.len());
        for (i, place) in self.baked.places(receivers).enumerate() {
            let mut point = Between::default();
            match place {
                Place::Dark => {}
                Place::Between(between) => {
                    for (k, (row, weight)) in between.into_iter().enumerate() {
                        (point.rows[k], point.weights[k]) = ((row * per_row) as u32, weight);
                    }
                }
                Place::Open => {
                    (point.rows[0], point.weights[0]) = (fours.len() as u32, 1.0);
                    let vector = self.baked.open_vector(frame, receivers.normal_at(i));
                    (0..channels).for_each(|_| fours.extend(in_fours(&vector)));
                }
            }
            points.push(point);
        }
        (fours, points)
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint.parts.extend([("receivers on the device", receivers), ("vectors and light on the device", others)]);
        footprint
    }

    fn details(&self) -> Vec<Detail> {
        self.baked.details()
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        let (rows, points) = self.rows(frame, receivers);
        self.runner.write(1, &rows).map_err(told)?;
        self.runner.write(2, &points).map_err(told)?;
        Ok(self.runner.place_receivers(frame, receivers, &|i| i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let uniforms = FrameUniforms::new(self.baked.frame_arrays(frame)?.light);
        self.runner.write_uniforms(&uniforms);
        let places = frame.world_from_object.iter().map(|pose| pose.translation.as_dvec3());
        self.runner.place_objects(frame, &KernelSpace::of_points(places, DMat3::IDENTITY))?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
