//! `unshadowed` on the device.

use crate::{
    kernels::UNSHADOWED,
    receivers::KernelSpace,
    rows::row,
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, Vec3};
use halfshade_scene::{Frame, Progress, Receivers, Scene, SphereLight, light::DistantLight};
use halfshade_strategies::{Unshadowed, unshadowed::Irradiance};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use std::f32::consts::PI;

/// [`Unshadowed`], whose light is added up on the device.
#[derive(Debug)]
pub struct UnshadowedOnGpu {
    bench: Bench,
}

/// Settings of a frame, as the shader reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct FrameUniforms {
    pub(crate) constant: [f32; 4],
    pub(crate) sun_direction: [f32; 4],
    pub(crate) sun_radiance: [f32; 4],
    pub(crate) light_count: u32,
    pub(crate) is_tabulated: u32,
    pub(crate) grid_cells: f32,
    pub(crate) padding: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct DeviceLight {
    /// Centre and radius.
    pub(crate) sphere: [f32; 4],
    pub(crate) radiance: [f32; 4],
}

struct BakedOnGpu {
    irradiance: Irradiance,
    runner: Runner,
}

impl UnshadowedOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for UnshadowedOnGpu {
    fn info(&self) -> Info {
        Unshadowed.info()
    }

    fn needs_spheres(&self) -> bool {
        Unshadowed.needs_spheres()
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let runner = Runner::new(&self.bench, &UNSHADOWED, None, &[], size_of::<FrameUniforms>())?;
        let mut baked = BakedOnGpu { irradiance: Unshadowed::irradiance(scene, params), runner };
        baked.write_table()?;
        Ok(Box::new(baked))
    }
}

impl BakedOnGpu {
    fn write_table(&mut self) -> Result<(), StrategyError> {
        let rows: Vec<[f32; 4]> = self.irradiance.table.iter().map(|value| row(*value, 0.0)).collect();
        Ok(self.runner.write(2, &rows)?)
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let [receivers, others] = self.runner.bytes();
        Footprint { parts: vec![("receivers on the device", receivers), ("tables and frame on the device", others)] }
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        Ok(self.runner.place_receivers(frame, receivers, &|_| 0)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let environment = &frame.scene.environment;
        if self.irradiance.set_base(&environment.base) {
            self.write_table()?;
        }
        let rotation = DMat3::from_quat(frame.world_from_environment.as_dquat().normalize().conjugate());
        let places = frame.world_from_object.iter().map(|pose| pose.translation.as_dvec3());
        let lights = frame.lights.iter().map(|light| light.center.as_dvec3());
        let space = KernelSpace::of_points(places.chain(lights), rotation);
        let placed = |light: &SphereLight| DeviceLight {
            sphere: space.place_sphere(light.center, light.radius),
            radiance: row(light.radiance, 0.0),
        };
        let lights: Vec<DeviceLight> = frame.lights.iter().map(placed).collect();
        let (constant, is_tabulated) = match &self.irradiance.base {
            DistantLight::Constant(radiance) => (PI * *radiance, false),
            DistantLight::Map(_) => (Vec3::ZERO, true),
        };
        let sun = environment.sun.map(|sun| {
            let direction = sun.direction.normalize_or(Vec3::Y);
            (row(direction, sun.angular_radius.sin()), row(sun.radiance, 0.0))
        });
        let (sun_direction, sun_radiance) = sun.unwrap_or_default();
        self.runner.write_uniforms(&FrameUniforms {
            constant: row(constant, 0.0),
            sun_direction,
            sun_radiance,
            light_count: lights.len() as u32,
            is_tabulated: is_tabulated.into(),
            grid_cells: self.irradiance.grid.cells() as f32,
            padding: 0,
        });
        self.runner.write(1, &lights)?;
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
