//! `shadow-field` in spherical harmonics on the device: fields and own occlusion stay there, poses and lights go up.
//!
//! Fields take as many bits there as they are stored in, but for samples that are filled up to 16 bytes. Where the CPU keeps a
//! vector for every light and lobe beside the others, a kernel has no room for them: it goes through the objects again for
//! each glossy lobe, and for each local light that has an object behind it.

pub(crate) mod buffers;
pub(crate) mod frame;
mod tables;

use crate::{
    GpuError,
    kernels::SHADOW_FIELD,
    pipeline::flag,
    receivers::KernelSpace,
    reflectance::most_terms,
    runner::{Bench, Runner, Uploaded},
};
use frame::{FrameUniforms, frame_rows};
use glam::DMat3;
use halfshade_scene::{Cache, Frame, Progress, Receivers, Scene};
use halfshade_sh::wgsl::MAX_WGSL_BANDS;
use halfshade_strategies::{
    ShadowField,
    shadow_field::{
        ShBaked,
        arrays::{FieldSettings, FrameArrays, Storage},
    },
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use tables::Tables;

/// [`ShadowField`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct ShadowFieldOnGpu {
    bench: Bench,
    strategy: ShadowField,
}

struct BakedOnGpu {
    baked: ShBaked,
    runner: Runner,
    tables: Tables,
    has_lights: bool,
}

impl ShadowFieldOnGpu {
    /// Keeps what takes rays in `cache`.
    pub(crate) fn new(bench: Bench, cache: Cache) -> Self {
        Self { bench, strategy: ShadowField::new(cache) }
    }
}

impl Strategy for ShadowFieldOnGpu {
    fn info(&self) -> Info {
        self.strategy.info()
    }

    fn needs_spheres(&self) -> bool {
        self.strategy.needs_spheres()
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let settings = FieldSettings::new(params);
        if let Some(missing) = missing(&settings) {
            return Err(StrategyError::Unsupported(format!("no kernels for graphics devices yet: {missing}")));
        }
        let baked = self.strategy.bake_sh(scene, params, progress)?;
        let constants = constants(&settings, scene);
        let bytes = size_of::<FrameUniforms>();
        let mut runner = Runner::new(&self.bench, &SHADOW_FIELD, settings.bands, &constants, bytes)?;
        let (tables, samples) = Tables::new(&baked.scene_arrays(), scene);
        runner.write(2, &samples).map_err(told("fields", "storage=u8, fewer shells or a lower resolution"))?;
        runner.write(3, &tables.rows)?;
        Ok(Box::new(BakedOnGpu { baked, runner, tables, has_lights: !scene.lights.is_empty() }))
    }
}

/// The wish of the settings that has no kernel, and what to do instead.
fn missing(settings: &FieldSettings) -> Option<&'static str> {
    match settings.bands {
        None => Some("basis=haar; take basis=sh, or device `cpu`"),
        Some(bands) if bands > MAX_WGSL_BANDS => Some("more than 6 bands; take fewer, or device `cpu`"),
        Some(_) => settings.is_traced.then_some("rays for fields; take sampling=adaptive, or device `cpu`"),
    }
}

/// Values of the kernel's `override`s.
fn constants(settings: &FieldSettings, scene: &Scene) -> [(&'static str, f64); 4] {
    let storage = match settings.storage {
        Storage::U8 => 0.0,
        Storage::F16 => 1.0,
        Storage::F32 => 2.0,
    };
    [
        ("STORAGE", storage),
        ("OWN_IS_PROJECTED", flag(settings.own_is_projected)),
        ("HAS_LIGHTS", flag(!scene.lights.is_empty())),
        ("LOBES", most_terms(scene) as f64),
    ]
}

/// An error, told with what to take instead if `what` is larger than the device can bind.
fn told(what: &str, instead: &str) -> impl Fn(GpuError) -> StrategyError {
    move |error| match error {
        GpuError::TooLarge { bytes, limit, .. } => StrategyError::Unsupported(format!(
            "{what} take {bytes} bytes, but the graphics device binds {limit} at most; take {instead}, or device `cpu`"
        )),
        error => error.into(),
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint.parts.extend([("receivers on the device", receivers), ("fields and frame on the device", others)]);
        footprint
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        let objects = receivers.object.iter().map(|&object| object as usize);
        self.tables.place_receivers(objects.zip(self.baked.vertices_around(receivers)));
        self.runner.write(3, &self.tables.rows).map_err(told("own occlusion and receivers", "fewer receivers"))?;
        Ok(self.runner.place_receivers(frame, receivers, &|i| i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let arrays = self.baked.prepare_frame(frame)?;
        if !(self.has_lights || arrays.lights.is_empty()) {
            let problem = "the frame has local lights, but the scene that fields were baked for had none";
            return Err(StrategyError::Failed(problem.into()));
        }
        let space = space_of(&arrays);
        let (rows, uniforms) = frame_rows(&arrays, &self.tables, &space, frame.scene.camera.eye);
        self.runner.write_uniforms(&uniforms);
        self.runner.write(1, &rows)?;
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

/// Light space, scaled so that all objects and lights have coordinates near 1.
fn space_of(arrays: &FrameArrays<'_>) -> KernelSpace {
    let objects = arrays.objects.iter().map(|object| (object.center, object.radius));
    let lights = arrays.lights.iter().map(|light| (light.center, light.radius));
    let reach = |(center, radius): ([f32; 3], f32)| center.map(|x| x.abs() + radius);
    let extent = objects.chain(lights).flat_map(reach).fold(0.0, f32::max);
    KernelSpace::around(arrays.origin, DMat3::from_quat(arrays.light_from_world), f64::from(extent))
}
