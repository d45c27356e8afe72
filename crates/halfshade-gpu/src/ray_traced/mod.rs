//! `ray-traced` on the device: shadow rays through hierarchies that stay there, one per mesh, under one over the objects.

pub(crate) mod buffers;
mod cutouts;
pub(crate) mod filter;
pub(crate) mod frame;
pub(crate) mod meshes;
mod tables;

use crate::{
    kernels::RAY_TRACED,
    pipeline::flag,
    runner::{Bench, Runner, Uploaded},
};
use filter::FilterOnGpu;
use frame::{FrameRows, FrameUniforms, Light, lasting_rows};
use halfshade_scene::{Frame, Progress, Receivers, Scene, light::DistantLight};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{FILTERS_SHARES, Irradiance, LightSampler, SampleArrays},
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use meshes::{Meshes, room_for_objects, space_of};
use tables::Tables;

/// [`RayTraced`], whose rays are traced on the device.
#[derive(Debug)]
pub struct RayTracedOnGpu {
    bench: Bench,
}

/// Vectors that kernels keep of a receiver; see `ray_traced/shade.wgsl`.
fn kept_vectors(samples: &SampleArrays) -> usize {
    match () {
        () if samples.is_product || samples.filter.is_some() => 4,
        () if samples.is_ratio => 2,
        () => 0,
    }
}

/// Most samples of a dispatch.
const SAMPLES_AT_ONCE: u32 = 64;

struct BakedOnGpu {
    runner: Runner,
    samples: SampleArrays,
    filter: Option<FilterOnGpu>,
    light: Option<LightSampler>,
    /// If light is to be known.
    irradiance: Option<Irradiance>,
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
        let constants = [
            ("SAMPLES_AT_ONCE", f64::from(SAMPLES_AT_ONCE)),
            ("IS_GLOSSY", flag(scene.is_glossy())),
            ("IS_RATIO", flag(samples.is_ratio)),
            ("IS_PRODUCT", flag(samples.is_product)),
            ("IS_FILTERED", flag(samples.filter.is_some())),
            ("HAS_CUTOUTS", flag(scene.objects.iter().any(|object| object.mesh.has_cutouts()))),
        ];
        let mut runner = Runner::new(&self.bench, &RAY_TRACED, None, &constants, size_of::<FrameUniforms>())?;
        runner.keep_vectors(kept_vectors(&samples));
        if samples.filter.is_some() && !samples.is_ratio {
            return Err(StrategyError::Unsupported(FILTERS_SHARES.into()));
        }
        let filter = samples.filter.map(|filter| FilterOnGpu::new(&self.bench, filter)).transpose()?;
        let irradiance = samples.irradiance(scene);
        let tables = Tables::new(scene);
        let meshes = Meshes::of(&scene.frame(0), &tables.holes);
        let mut baked = BakedOnGpu { runner, samples, filter, light: None, irradiance, resident: None, tables, meshes };
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
        let neighbours = self.filter.as_ref().map_or(0, FilterOnGpu::bytes);
        Footprint {
            parts: vec![
                ("receivers on the device", receivers),
                ("neighbours on the device", neighbours),
                ("hierarchies and light on the device", others),
            ],
        }
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        self.runner.place_receivers(frame, receivers, &|i| receivers.index[i])?;
        if let Some(filter) = &mut self.filter {
            let followers = filter.followers(self.runner.gpu(), frame, receivers, &self.runner.receiver_ranges())?;
            self.runner.run_after(followers);
        }
        Ok(())
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
        let sampler = LightSampler::new(frame, known);
        let sampler = self.light.insert(if self.samples.is_product { sampler.with_tree() } else { sampler });
        if let Some(irradiance) = &mut self.irradiance {
            irradiance.set_base(&sampler.base);
        }
        let light = Light { sampler, irradiance: self.irradiance.as_ref() };
        let space = space_of(frame, &self.meshes);
        let FrameRows { mut rows, uniforms } =
            FrameRows::new(frame, &mut self.meshes, &space, &self.tables, &light, &self.samples)?;
        self.runner.write_part(1, &self.meshes.nodes[..room_for_objects(frame.scene.objects.len())]);
        let first_table = rows.len();
        let is_there =
            self.resident.as_ref().is_some_and(|(map, row)| *row == first_table && map.is_same_as(&light.sampler.base));
        if is_there {
            self.runner.write_part(3, &rows);
        } else {
            rows.extend(lasting_rows(first_table, &self.tables, &light));
            self.runner.write(3, &rows)?;
            self.resident = Some((light.sampler.base.clone(), first_table));
        }
        self.runner.write_uniforms(&uniforms);
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
