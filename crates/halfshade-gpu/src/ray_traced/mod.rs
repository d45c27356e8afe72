//! `ray-traced` on the device: shadow rays through hierarchies that stay there, one per mesh, under one over the objects.

pub(crate) mod buffers;
mod cutouts;
pub(crate) mod frame;
pub(crate) mod meshes;
mod tables;

use crate::{
    kernels::RAY_TRACED,
    pipeline::flag,
    runner::{Bench, Runner, Uploaded},
};
use frame::{FrameRows, FrameUniforms, lasting_rows};
use halfshade_scene::{Frame, Progress, Receivers, Scene, light::DistantLight};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{LightSampler, SampleArrays},
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use meshes::{Meshes, room_for_objects, space_of};
use tables::Tables;

/// [`RayTraced`], whose rays are traced on the device.
#[derive(Debug)]
pub struct RayTracedOnGpu {
    bench: Bench,
}

/// Most samples of a dispatch.
const SAMPLES_AT_ONCE: u32 = 64;

struct BakedOnGpu {
    runner: Runner,
    samples: SampleArrays,
    light: Option<LightSampler>,
    /// The light whose map is on the device behind the tables, and the row at which those begin.
    resident: Option<(DistantLight, usize)>,
    tables: Tables,
    meshes: Meshes,
}

impl RayTracedOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for RayTracedOnGpu {
    fn info(&self) -> Info {
        RayTraced.info()
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let samples = SampleArrays::new(params);
        if samples.is_ratio {
            return Err(StrategyError::Unsupported("no kernels for graphics devices yet: estimator=ratio".into()));
        }
        let constants = [
            ("SAMPLES_AT_ONCE", f64::from(SAMPLES_AT_ONCE)),
            ("IS_GLOSSY", flag(scene.is_glossy())),
            ("HAS_CUTOUTS", flag(scene.objects.iter().any(|object| object.mesh.has_cutouts()))),
        ];
        let runner = Runner::new(&self.bench, &RAY_TRACED, None, &constants, size_of::<FrameUniforms>())?;
        let tables = Tables::new(scene);
        let meshes = Meshes::of(&scene.frame(0), &tables.holes);
        let mut baked = BakedOnGpu { runner, samples, light: None, resident: None, tables, meshes };
        baked.runner.write(1, &baked.meshes.nodes)?;
        baked.runner.write(2, &baked.meshes.triangles)?;
        let samples = baked.samples.samples;
        let parts: Vec<[u32; 4]> =
            (0..samples).step_by(SAMPLES_AT_ONCE as usize).map(|first| [first, 0, 0, 0]).collect();
        baked.runner.set_parts(&parts)?;
        Ok(Box::new(baked))
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let [receivers, others] = self.runner.bytes();
        Footprint {
            parts: vec![("receivers on the device", receivers), ("hierarchies and light on the device", others)],
        }
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        Ok(self.runner.place_receivers(frame, receivers, &|i| receivers.index[i])?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        if self.meshes.of_object.len() != frame.scene.objects.len() {
            return Err(StrategyError::Failed("the frame is of another scene than hierarchies were baked for".into()));
        }
        if self.meshes.is_deformed || frame.deformed.iter().any(Option::is_some) {
            self.meshes = Meshes::of(frame, &self.tables.holes);
            self.runner.write(1, &self.meshes.nodes)?;
            self.runner.write(2, &self.meshes.triangles)?;
        }
        let known = self.light.take();
        let light = self.light.insert(LightSampler::new(frame, known));
        let space = space_of(frame, &self.meshes);
        let FrameRows { mut rows, uniforms } =
            FrameRows::new(frame, &mut self.meshes, &space, &self.tables, light, &self.samples)?;
        self.runner.write_part(1, &self.meshes.nodes[..room_for_objects(frame.scene.objects.len())]);
        let first_table = rows.len();
        let is_there =
            self.resident.as_ref().is_some_and(|(map, row)| *row == first_table && map.is_same_as(&light.base));
        if is_there {
            self.runner.write_part(3, &rows);
        } else {
            rows.extend(lasting_rows(&self.tables, light));
            self.runner.write(3, &rows)?;
            self.resident = Some((light.base.clone(), first_table));
        }
        self.runner.write_uniforms(&uniforms);
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
