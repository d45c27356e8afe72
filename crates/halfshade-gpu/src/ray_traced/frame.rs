//! A frame in rows of four numbers, and its settings.

use super::{meshes::Meshes, tables::Tables};
use crate::{
    GpuError,
    receivers::KernelSpace,
    rows::{Row, bits, fours, row},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_scene::{
    Frame,
    light::{DistantLight, EnvironmentMap},
};
use halfshade_strategies::ray_traced::arrays::{AliasTable, Irradiance, Level, LightSampler, SampleArrays};

/// Settings of a frame, as `ray_traced/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
pub struct FrameUniforms {
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
    pub(crate) irradiances: u32,
    pub(crate) grid_cells: f32,
    pub(crate) levels: u32,
    pub(crate) level_count: u32,
    pub(crate) solid_angles: u32,
    pub(crate) sums: u32,
    pub(crate) largest: [u32; 2],
    pub(crate) normal_cells: f32,
    pub(crate) order: u32,
    pub(crate) padding: [u32; 3],
}

/// Rows that change with a frame, and settings that say where they and those that stay begin.
pub(super) struct FrameRows {
    pub(super) rows: Vec<Row>,
    pub(super) uniforms: FrameUniforms,
}

impl FrameRows {
    /// Builds the hierarchy over the frame's objects, too.
    pub(super) fn new(
        frame: &Frame<'_>,
        meshes: &mut Meshes,
        space: &KernelSpace,
        tables: &Tables,
        light: &Light<'_>,
        samples: &SampleArrays,
    ) -> Result<Self, GpuError> {
        let Light { sampler: light, irradiance } = light;
        let instances = meshes.instances(frame, space)?;
        let mut rows: Vec<Row> = instances.concat();
        // Room for objects that can't be met, too: what follows stays where it is.
        rows.resize(4 * frame.scene.objects.len(), [0; 4]);
        let first_light = rows.len();
        for light in &light.lights {
            rows.push(space.place_sphere(light.center, light.radius).map(f32::to_bits));
            rows.push(bits(light.radiance, 0.0));
        }
        let first_table = rows.len();
        let places = LightPlaces::new(first_table + tables.rows.len(), light, *irradiance);
        let uniforms = FrameUniforms {
            eye: space.place_sphere(frame.scene.camera.eye, 0.0),
            lights: first_light as u32,
            light_count: light.lights.len() as u32,
            instance_count: instances.len() as u32,
            tables: first_table as u32,
            texels: places.texels as u32,
            aliases: places.aliases as u32,
            irradiances: places.irradiances as u32,
            grid_cells: irradiance.map_or(0.0, |irradiance| irradiance.grid.cells() as f32),
            levels: places.levels as u32,
            solid_angles: places.solid_angles as u32,
            sums: places.sums as u32,
            order: places.order as u32,
            ..uniforms(light, samples)
        };
        Ok(Self { rows, uniforms })
    }
}

/// Light of a frame, and all of it that arrives by a normal if rays are to tell only a share.
pub(super) struct Light<'a> {
    pub(super) sampler: &'a LightSampler,
    pub(super) irradiance: Option<&'a Irradiance>,
}

/// Rows at which what stays of the light begins.
struct LightPlaces {
    texels: usize,
    aliases: usize,
    irradiances: usize,
    levels: usize,
    cells: usize,
    solid_angles: usize,
    order: usize,
    sums: usize,
}

impl LightPlaces {
    fn new(first: usize, light: &LightSampler, irradiance: Option<&Irradiance>) -> Self {
        let texel_count = if let DistantLight::Map(map) = &light.base { map.texels().len() } else { 0 };
        let aliases = first + texel_count;
        let irradiances = aliases + light.alias.cells.len().div_ceil(4);
        let levels = irradiances + irradiance.map_or(0, |irradiance| irradiance.table.len());
        let sizes = light.tree.as_ref().map_or([0; 4], |tree| {
            let [solid_angles, order] = [tree.solid_angles.len(), tree.order.len()].map(|count| count.div_ceil(4));
            [tree.levels.len(), tree.cells.len(), solid_angles, order]
        });
        let cells = levels + sizes[0];
        let solid_angles = cells + sizes[1];
        let order = solid_angles + sizes[2];
        Self { texels: first, aliases, irradiances, levels, cells, solid_angles, order, sums: order + sizes[3] }
    }
}

/// Rows that stay as long as the light from afar does, behind those of a frame, which are `first` many.
pub(super) fn lasting_rows(first: usize, tables: &Tables, light: &Light<'_>) -> Vec<Row> {
    let mut rows = tables.rows.clone();
    if let DistantLight::Map(map) = &light.sampler.base {
        rows.extend(map_rows(map, &light.sampler.alias));
    }
    let irradiances = light.irradiance.map_or(&[][..], |irradiance| &irradiance.table);
    rows.extend(irradiances.iter().map(|value| bits(*value, 0.0)));
    if let Some(tree) = &light.sampler.tree {
        let places = LightPlaces::new(first + tables.rows.len(), light.sampler, light.irradiance);
        let level = |level: &Level| {
            let [columns, rows] = level.size.map(|size| size as u32);
            [columns, rows, (places.cells + level.first) as u32, level.across.to_bits()]
        };
        rows.extend(tree.levels.iter().map(level));
        rows.extend(tree.cells.iter().map(|cell| cell.to_array().map(f32::to_bits)));
        rows.extend(fours(tree.solid_angles.iter().map(|angle| angle.to_bits())));
        rows.extend(fours(tree.order.iter().copied()));
        rows.extend(fours(tree.sums.iter().map(|sum| sum.to_bits())));
    }
    rows
}

/// Texels of a map, each with the chance to stay at it, and where to go otherwise. A black map draws no direction.
fn map_rows(map: &EnvironmentMap, alias: &AliasTable) -> impl Iterator<Item = Row> {
    let stay = |texel: usize| alias.cells.get(texel).map_or(1.0, |(stay, _)| *stay as f32);
    let texels = map.texels().iter().enumerate().map(move |(i, texel)| bits(*texel, stay(i)));
    texels.chain(fours(alias.cells.iter().map(|(_, other)| *other)))
}

/// All settings that are known without the rows.
fn uniforms(light: &LightSampler, samples: &SampleArrays) -> FrameUniforms {
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
        level_count: light.tree.as_ref().map_or(0, |tree| tree.levels.len() as u32),
        largest: light.tree.as_ref().map_or([0; 2], |tree| tree.largest.map(|size| size as u32)),
        normal_cells: light.tree.as_ref().map_or(0.0, |tree| tree.grid.cells() as f32),
        ..FrameUniforms::default()
    }
}
