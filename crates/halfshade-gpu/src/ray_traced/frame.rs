//! Settings of a frame.

use crate::rows::row;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_scene::light::DistantLight;
use halfshade_strategies::ray_traced::arrays::{LightSampler, SampleArrays};

/// Settings of a frame, as `ray_traced/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
pub(crate) struct FrameUniforms {
    pub(crate) environment: [[f32; 4]; 3],
    pub(crate) constant: [f32; 4],
    pub(crate) sun: [f32; 4],
    pub(crate) sun_radiance: [f32; 4],
    pub(crate) eye: [f32; 4],
    pub(crate) plane_steps: [u32; 4],
    pub(crate) space_steps: [u32; 4],
    pub(crate) space_last_step: [u32; 2],
    pub(crate) samples: u32,
    pub(crate) cosine_share: f32,
    pub(crate) base_power: f32,
    pub(crate) sun_power: f32,
    pub(crate) map_width: u32,
    pub(crate) map_height: u32,
    pub(crate) instances: u32,
    pub(crate) instance_count: u32,
    pub(crate) lights: u32,
    pub(crate) light_count: u32,
    pub(crate) tables: u32,
    pub(crate) texels: u32,
    pub(crate) aliases: u32,
    pub(crate) padding: u32,
}

/// All settings that are known without the rows.
pub(super) fn uniforms(light: &LightSampler, samples: &SampleArrays) -> FrameUniforms {
    let halves = |step: u64| [step as u32, (step >> 32) as u32];
    let [a, b] = samples.plane_steps.map(halves);
    let [x, y, z] = samples.space_steps.map(halves);
    let (constant, [map_width, map_height]) = match &light.base {
        DistantLight::Constant(radiance) => (*radiance, [0; 2]),
        DistantLight::Map(map) => (Vec3::ZERO, [map.width() as u32, map.height() as u32]),
    };
    let sun = light.sun.as_ref().map(|(sun, power)| {
        let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        (row(sun.direction.normalize_or(Vec3::Y), versine as f32), row(sun.radiance, 0.0), *power as f32)
    });
    let (sun, sun_radiance, sun_power) = sun.unwrap_or(([0.0, 1.0, 0.0, -1.0], [0.0; 4], 0.0));
    let by_cosine_alone = samples.cosine_share > 0.0 && light.is_constant();
    FrameUniforms {
        environment: std::array::from_fn(|k| row(light.environment_from_world.row(k), 0.0)),
        constant: row(constant, 0.0),
        sun,
        sun_radiance,
        plane_steps: [a[0], a[1], b[0], b[1]],
        space_steps: [x[0], x[1], y[0], y[1]],
        space_last_step: z,
        samples: samples.samples,
        cosine_share: if by_cosine_alone { 1.0 } else { samples.cosine_share as f32 },
        base_power: light.base_power as f32,
        sun_power,
        map_width,
        map_height,
        ..FrameUniforms::default()
    }
}
