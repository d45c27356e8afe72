//! Tables of the scene and its light in one buffer, and where in it they begin.

use super::own::OwnRows;
use crate::rows::{filled, in_fours};
use bytemuck::{Pod, Zeroable};
use halfshade_sh::kernel::{BatchExponential, ExposedShares};
use halfshade_strategies::sh_exp::arrays::{
    BaseByNormal, CombinationArrays, DistantLightByNormal, FrameArrays, LAMP_POINTS, ReflectionArrays, SceneArrays,
};

/// Settings of a frame, as `sh_exp/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `sh_exp/frame.wgsl`")]
pub struct FrameUniforms {
    pub cosine: [f32; 8],
    pub reflectance: [f32; 8],
    pub light: [f32; 4],
    pub sun_direction: [f32; 4],
    pub sun_perpendicular: [f32; 4],
    pub shadow_table: LinearTable,
    pub reflection_table: LinearTable,
    pub light_table: u32,
    pub sun_table: u32,
    pub log_table: u32,
    pub form_table: u32,
    pub grid_cells: f32,
    pub masks: u32,
    pub ground: u32,
    pub fan: u32,
    pub share_space: [[f32; 4]; 3],
    pub own_receivers: u32,
    pub own_rotations: u32,
    pub own_spheres: u32,
    pub lamps: u32,
    pub lamp_fan: u32,
    pub mean_normals: u32,
    pub padding: [u32; 2],
}

/// A table of the optimal linear form.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `sh_exp/frame.wgsl`")]
pub struct LinearTable {
    pub row: u32,
    pub last: f32,
    pub limit: f32,
    pub per_magnitude: f32,
}

/// Rows of four, and the settings that tell of them.
#[derive(Debug, Default)]
pub struct Tables {
    /// Rows.
    pub rows: Vec<[f32; 4]>,
    /// Channels of light by normal; 0 of constant light.
    pub light_channels: u32,
    /// Settings of the scene and its light; those of spheres are 0.
    pub uniforms: FrameUniforms,
}

impl Tables {
    /// For a frame under the light of another, too.
    pub fn new(arrays: &SceneArrays<'_>, frame: &FrameArrays<'_>, own: Option<&OwnRows>) -> Self {
        let mut tables = Self::default();
        // Blockers are expected at row 0.
        tables.add_eights(arrays.blockers.rows());
        match arrays.combination {
            CombinationArrays::Exponential(exponential) => {
                tables.uniforms.shadow_table = tables.add_linear(exponential);
            }
            CombinationArrays::Shares { points } => tables.uniforms.fan = tables.add_fan(points),
            CombinationArrays::Product | CombinationArrays::Traced => {}
        }
        if let Some(reflections) = &arrays.reflections {
            tables.add_reflections(arrays, reflections);
        }
        let cosine = arrays.reflections.map(|reflections| reflections.cosine).or(arrays.ground_cosine);
        tables.uniforms.reflectance = filled(cosine.unwrap_or_default());
        tables.add_light(arrays.bands, frame.light);
        tables.uniforms.lamp_fan = tables.add_fan(LAMP_POINTS);
        if let Some(own) = own {
            tables.uniforms.own_receivers = tables.next_row() + own.first_receiver() as u32;
            let vectors = tables.next_row();
            tables.rows.extend(own.rows(vectors));
        }
        tables
    }

    fn next_row(&self) -> u32 {
        self.rows.len() as u32
    }

    fn add_eights(&mut self, rows: impl Iterator<Item = [f32; 8]>) {
        self.rows.extend(rows.flat_map(|[a, b, c, d, e, f, g, h]| [[a, b, c, d], [e, f, g, h]]));
    }

    fn add_linear(&mut self, exponential: &BatchExponential) -> LinearTable {
        let parts = exponential.parts();
        let table = LinearTable {
            row: self.next_row(),
            last: parts.table.len().saturating_sub(1) as f32,
            limit: parts.table_limit,
            per_magnitude: parts.entries_per_magnitude,
        };
        self.rows.extend(parts.table);
        table
    }

    /// Gives the row at which it begins.
    fn add_fan(&mut self, points: usize) -> u32 {
        let first = self.next_row();
        self.rows.extend(ExposedShares::fan(points).map(|[share, cosine, sine]| [share, cosine, sine, 1.0]));
        // Eight points are looked at together.
        let end = self.rows.len() + points.next_multiple_of(8) - points;
        self.rows.resize(end, [0.0; 4]);
        first
    }

    fn add_reflections(&mut self, arrays: &SceneArrays<'_>, reflections: &ReflectionArrays<'_>) {
        self.uniforms.reflection_table = self.add_linear(reflections.exponential);
        if !std::ptr::eq(reflections.logs, arrays.blockers) {
            self.uniforms.log_table = self.next_row();
            self.add_eights(reflections.logs.rows());
        }
        self.uniforms.form_table = self.next_row();
        self.add_eights(reflections.form.rows());
        if let Some(table) = reflections.mean_normal {
            self.uniforms.mean_normals = self.next_row();
            self.rows.extend(in_fours(table.values().as_flattened()));
        }
    }

    fn add_light(&mut self, bands: usize, light: &DistantLightByNormal) {
        self.uniforms.cosine = filled(&light.cosine);
        self.uniforms.grid_cells = light.grid.cells() as f32;
        self.uniforms.light_table = self.next_row();
        match &light.base {
            BaseByNormal::Constant(radiance) => self.uniforms.light = radiance.extend(0.0).to_array(),
            BaseByNormal::Table { rows: eights, channels } => {
                self.light_channels = *channels as u32;
                let count = bands * bands;
                // Rows of eight are filled up with zeros; rows of four need fewer of them.
                for vector in eights.chunks_exact(count.div_ceil(8)) {
                    let values: Vec<f32> = vector.iter().flat_map(|eight| eight.to_array()).collect();
                    self.rows.extend(&values.as_chunks::<4>().0[..count.div_ceil(4)]);
                }
            }
        }
        self.uniforms.sun_table = self.next_row();
        if let Some(sun) = &light.sun {
            let ([x, y, z], [r, g, b]) = (sun.direction, sun.perpendicular);
            self.uniforms.sun_direction = [x, y, z, 0.0];
            self.uniforms.sun_perpendicular = [r, g, b, sun.sin_radius as f32];
            self.rows.extend(in_fours(&sun.basis));
        }
    }
}
