//! `ray-traced` on the device: shadow rays through hierarchies that stay there, one per mesh, under one over the objects.

mod cutouts;
pub(crate) mod frame;
pub(crate) mod meshes;
mod tables;

use crate::{
    kernels::RAY_TRACED,
    pipeline::flag,
    rows::{Row, bits, fours},
    runner::{Bench, Runner, Uploaded},
};
use frame::{FrameUniforms, uniforms};
use halfshade_scene::{
    Frame, Progress, Receivers, Scene,
    light::{DistantLight, EnvironmentMap},
};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{AliasTable, LightSampler, SampleArrays},
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
        let constants = [
            ("SAMPLES_AT_ONCE", f64::from(SAMPLES_AT_ONCE)),
            ("IS_GLOSSY", flag(scene.is_glossy())),
            ("HAS_CUTOUTS", flag(scene.objects.iter().any(|object| object.mesh.has_cutouts()))),
        ];
        let runner = Runner::new(&self.bench, &RAY_TRACED, None, &constants, size_of::<FrameUniforms>())?;
        let tables = Tables::new(scene);
        let meshes = Meshes::of(&scene.frame(0), &tables.holes);
        let samples = SampleArrays::new(params);
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
        let instances = self.meshes.instances(frame, &space)?;
        self.runner.write_part(1, &self.meshes.nodes[..room_for_objects(frame.scene.objects.len())]);
        let mut rows: Vec<Row> = instances.concat();
        // Room for objects that can't be met, too: what follows stays where it is.
        rows.resize(4 * frame.scene.objects.len(), [0; 4]);
        let first_light = rows.len();
        for light in &light.lights {
            rows.push(space.place_sphere(light.center, light.radius).map(f32::to_bits));
            rows.push(bits(light.radiance, 0.0));
        }
        let first_table = rows.len();
        let first_texel = first_table + self.tables.rows.len();
        let texel_count = if let DistantLight::Map(map) = &light.base { map.texels().len() } else { 0 };
        let uniforms = FrameUniforms {
            eye: space.place_sphere(frame.scene.camera.eye, 0.0),
            lights: first_light as u32,
            light_count: light.lights.len() as u32,
            instance_count: instances.len() as u32,
            tables: first_table as u32,
            texels: first_texel as u32,
            aliases: (first_texel + texel_count) as u32,
            ..uniforms(light, &self.samples)
        };
        let is_there =
            self.resident.as_ref().is_some_and(|(map, row)| *row == first_table && map.is_same_as(&light.base));
        if is_there {
            self.runner.write_part(3, &rows);
        } else {
            rows.extend(&self.tables.rows);
            if let DistantLight::Map(map) = &light.base {
                rows.extend(map_rows(map, &light.alias));
            }
            self.runner.write(3, &rows)?;
            self.resident = Some((light.base.clone(), first_table));
        }
        self.runner.write_uniforms(&uniforms);
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

/// Texels of a map, each with the chance to stay at it, and where to go otherwise. A black map draws no direction.
fn map_rows(map: &EnvironmentMap, alias: &AliasTable) -> impl Iterator<Item = Row> {
    let stay = |texel: usize| alias.cells.get(texel).map_or(1.0, |(stay, _)| *stay as f32);
    let texels = map.texels().iter().enumerate().map(move |(i, texel)| bits(*texel, stay(i)));
    texels.chain(fours(alias.cells.iter().map(|(_, other)| *other)))
}
