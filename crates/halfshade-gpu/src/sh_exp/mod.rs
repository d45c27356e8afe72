//! `sh-exp` on the device: shadows, and both passes of reflections.

mod constants;
pub(crate) mod first_pass;
pub(crate) mod frame;
pub(crate) mod own;
pub(crate) mod tables;

use crate::{
    GpuError,
    kernels::SH_EXP,
    receivers::{KernelSpace, affine_rows},
    runner::{Bench, Runner, Uploaded},
};
use constants::{Constants, constants, missing};
use first_pass::{DeviceFirstPass, Kernels};
use glam::DVec3;
use halfshade_scene::{Frame, Progress, Receivers, Scene};
use halfshade_strategies::{
    ShExp,
    sh_exp::{BakedScene, arrays::FirstPass},
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use own::OwnRows;
use tables::{FrameUniforms, Tables};

/// Places of the kernel's buffers in group 1.
const BLOCKERS: usize = 1;
const NUMBERS: usize = 2;
const TABLES: usize = 3;
const RADIATING: usize = 4;

/// [`ShExp`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct ShExpOnGpu {
    bench: Bench,
}

struct BakedOnGpu {
    bench: Bench,
    baked: BakedScene,
    runner: Runner,
    /// Values of the kernel's `override`s: of receivers, and of sample points in the dark.
    constants: [Constants; 2],
    /// Where spheres radiate without the processor, from the first frame on.
    first_pass: Option<DeviceFirstPass>,
    uniforms: FrameUniforms,
    light_channels: u32,
    /// Own occlusion and who knows it, if meshes tell.
    own: Option<OwnRows>,
    /// Changes of the light up to which tables are on the device.
    light_changes: Option<u32>,
}

impl ShExpOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for ShExpOnGpu {
    fn info(&self) -> Info {
        ShExp.info()
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let baked = ShExp::bake_scene(scene, params, progress)?;
        let arrays = baked.scene_arrays();
        if let Some(missing) = missing(&arrays) {
            return Err(StrategyError::Unsupported(format!("no kernels for graphics devices yet: {missing}")));
        }
        let constants = constants(&arrays);
        let (bands, uniform_bytes) = (Some(arrays.bands), size_of::<FrameUniforms>());
        Ok(Box::new(BakedOnGpu {
            runner: Runner::new(&self.bench, &SH_EXP, bands, &constants[0], uniform_bytes)?,
            own: OwnRows::new(&arrays, scene.objects.len()),
            bench: self.bench.clone(),
            baked,
            constants,
            first_pass: None,
            uniforms: FrameUniforms::default(),
            light_channels: 0,
            light_changes: None,
        }))
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        let reflections = self.first_pass.as_ref().map_or(0, DeviceFirstPass::bytes);
        footprint.parts.extend([
            ("receivers on the device", receivers),
            ("tables and frame on the device", others),
            ("reflections on the device", reflections),
        ]);
        footprint
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        self.baked.prepare_frame(frame, self.baked.first_pass())?;
        let cuts = self.baked.cut_of(receivers);
        let cut = |i: usize| cuts.as_ref().map_or(0, |cuts| cuts[i]);
        let arrays = self.baked.scene_arrays();
        let Some((own, own_arrays)) = self.own.as_mut().zip(arrays.own) else {
            return Ok(self.runner.place_receivers(frame, receivers, &cut)?);
        };
        own.clear();
        // Sample points come first, as `first_pass` expects it.
        if let Some(reflections) = arrays.reflections {
            let (points, emitters) = reflections.sample_points(frame);
            let cuts = self.baked.cut_of_emitters(&emitters);
            own.add(&own_arrays, points.view(), &|i| cuts.as_ref().map_or(0, |cuts| cuts[i]));
        }
        let first = own.add(&own_arrays, receivers, &cut);
        self.light_changes = None;
        Ok(self.runner.place_receivers(frame, receivers, &|i| first + 2 * i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.baked.prepare_frame(frame, self.baked.first_pass())?;
        self.prepare_on_device(frame)?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

impl BakedOnGpu {
    fn prepare_on_device(&mut self, frame: &Frame<'_>) -> Result<(), GpuError> {
        let Self { baked, runner, .. } = self;
        let (scene, of_frame) = (baked.scene_arrays(), baked.frame_arrays());
        frame::check_rounds(runner.gpu(), &scene, baked.cuts().map(<[_]>::len).max().unwrap_or(0))?;
        let space = frame::space(baked, &of_frame);
        if self.light_changes != Some(of_frame.light_changes) {
            let tables = Tables::new(&scene, &of_frame, self.own.as_ref());
            runner.write(TABLES, &tables.rows)?;
            (self.uniforms, self.light_channels) = (tables.uniforms, tables.light_channels);
            self.light_changes = Some(of_frame.light_changes);
        }
        runner.write(BLOCKERS, &frame::blockers(baked, &space))?;
        let channels = of_frame.radiance_channels;
        let has_sun = u32::from(of_frame.light.sun.as_ref().is_some_and(|sun| sun.sin_radius > 0.0));
        let ground_rows = frame::ground_rows(&scene, &of_frame);
        let lamps = of_frame.lamps.len() as u32;
        let counts = [self.light_channels, channels as u32, ground_rows, has_sun, lamps, 0, 0, 0];
        let (mut numbers, masks) = frame::numbers(baked, &scene, counts);
        [self.uniforms.own_rotations, self.uniforms.own_spheres] =
            own::add_objects(&mut numbers, scene.bands, &of_frame);
        self.uniforms.lamps = frame::add_lamps(&mut numbers, of_frame.lamps, &space);
        runner.write(NUMBERS, &numbers)?;
        self.uniforms.masks = masks;
        self.uniforms.share_space = affine_rows(of_frame.blockers_from_light, DVec3::ZERO);
        runner.place_objects(frame, &space)?;
        if baked.first_pass() == FirstPass::Here || scene.reflections.is_none() {
            let radiating = frame::radiating(&scene, &of_frame, &space, &mut self.uniforms);
            runner.write(RADIATING, &radiating)?;
        } else {
            self.prepare_first_pass(frame, &space)?;
        }
        self.runner.write_uniforms(&self.uniforms);
        let is_new = self.runner.upload()?;
        if let Some((pass, radiance)) = self.first_pass.as_mut().zip(self.runner.buffer(RADIATING))
            && let Some(passes) = pass.passes(&self.runner, radiance, is_new)
        {
            self.runner.run_before(passes);
        }
        Ok(())
    }

    /// Brings sample points up to a frame, and makes room for what spheres radiate.
    fn prepare_first_pass(&mut self, frame: &Frame<'_>, space: &KernelSpace) -> Result<(), GpuError> {
        let (scene, of_frame) = (self.baked.scene_arrays(), self.baked.frame_arrays());
        let Some(reflections) = &scene.reflections else { return Ok(()) };
        let pass = match &mut self.first_pass {
            Some(known) => known,
            none => {
                let [lit, dark] = &self.constants;
                let kernels = Kernels { bands: scene.bands, dark, lit, knows_own: scene.own.is_some() };
                none.insert(DeviceFirstPass::new(&self.bench, &kernels, &self.baked, reflections, frame)?)
            }
        };
        pass.prepare(reflections, &of_frame, frame, space)?;
        self.runner
            .reserve(RADIATING, pass.sphere_count() * of_frame.radiance_channels * frame::rows_of(scene.bands) * 16)
    }
}
