//! `mask` on the device: directions, light over lobes and what meshes hide from themselves stay there, spheres, boxes
//! and lamps go up.

use crate::{
    GpuError,
    kernels::MASK,
    pipeline::flag,
    placed::{PLACED_ROWS, Placed, constant_or_cells, node_rows},
    reflectance::{TERM_ROWS, terms},
    rows::{Row, row},
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_scene::{
    Frame, Progress, Receivers, Scene,
    spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT},
};
use halfshade_strategies::{
    Mask,
    mask::{
        BakedScene,
        arrays::{FrameArrays, OwnPoint, PlacedBox, SetArrays},
    },
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};

/// Places of the kernel's buffers in group 1.
const ROWS: usize = 1;
const TABLES: usize = 2;
const CELLS: usize = 3;

/// Numbers for each receiver at the beginning of the cells.
const NUMBERS_PER_RECEIVER: usize = 8;

/// [`Mask`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct MaskOnGpu {
    bench: Bench,
}

/// Settings of a frame, as the shader reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `mask/frame.wgsl`")]
pub struct FrameUniforms {
    pub constant: [f32; 4],
    pub eye: [f32; 4],
    pub grid_cells: f32,
    pub normal_cells: f32,
    pub edge: f32,
    pub lamp_directions: f32,
    pub sphere_count: u32,
    pub box_count: u32,
    pub lamp_count: u32,
    pub set_sixteens: u32,
    pub lamp_sixteens: u32,
    pub boxes: u32,
    pub lamps: u32,
    pub sets: u32,
    pub spiral: u32,
    pub own_side: u32,
    pub levels: u32,
    pub level_count: u32,
    pub lobe_spiral: u32,
    pub lobe_sixteens: u32,
    pub objects: u32,
    pub padding: u32,
}

struct BakedOnGpu {
    baked: BakedScene,
    runner: Runner,
    uniforms: FrameUniforms,
    /// Terms of every object, as [`reflectances`] has them.
    reflectances: Vec<u32>,
    /// Changes of the light, and directions into each lamp, for which tables are on the device.
    tables_of: Option<(u32, usize)>,
}

impl MaskOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for MaskOnGpu {
    fn info(&self) -> Info {
        Mask.info()
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let baked = Mask::bake_scene(scene, params, progress);
        let arrays = baked.scene_arrays();
        let (rule, full_height) = match arrays.rule {
            AdjustRule::Continuous => (0.0, FADE_HEIGHT),
            AdjustRule::Covering => (1.0, COVER_HEIGHT),
            AdjustRule::Published => (2.0, 1.0),
        };
        let constants = [("RULE", rule), ("FULL_HEIGHT", full_height), ("IS_GLOSSY", flag(scene.is_glossy()))];
        let runner = Runner::new(&self.bench, &MASK, None, &constants, size_of::<FrameUniforms>())?;
        let uniforms = FrameUniforms {
            normal_cells: arrays.normal_cells as f32,
            edge: arrays.edge,
            own_side: arrays.own_side as u32,
            ..FrameUniforms::default()
        };
        let mut baked = BakedOnGpu { baked, runner, uniforms, reflectances: reflectances(scene), tables_of: None };
        baked.write_cells(&[])?;
        Ok(Box::new(baked))
    }
}

impl BakedOnGpu {
    /// Writes where receivers lie between vertices, and what meshes hide from those.
    fn write_cells(&mut self, points: &[Option<OwnPoint>]) -> Result<(), GpuError> {
        let first = (NUMBERS_PER_RECEIVER * points.len()) as u32;
        let mut cells: Vec<u32> = Vec::with_capacity(first as usize);
        for point in points {
            let known = point.unwrap_or(OwnPoint { words: [0; 3], weights: [0.0; 3], is_all_open: true });
            cells.extend(known.words.map(|word| first + word));
            cells.extend(known.weights.map(f32::to_bits));
            cells.extend([u32::from(point.is_some()), u32::from(known.is_all_open)]);
        }
        cells.extend(self.baked.own_words());
        self.uniforms.objects = cells.len() as u32;
        cells.extend(&self.reflectances);
        self.runner.write(CELLS, &cells)
    }

    /// Writes tables, if light or lamps are others than before.
    fn write_tables(&mut self, light: (u32, usize), irradiance: &[[f32; 4]]) -> Result<(), GpuError> {
        if self.tables_of == Some(light) {
            return Ok(());
        }
        let mut rows = irradiance.to_vec();
        self.uniforms.sets = rows.len() as u32;
        for set in self.baked.sets() {
            self.uniforms.set_sixteens = (set.directions.len() / 16) as u32;
            rows.extend(rows_of_set(&set));
        }
        self.uniforms.spiral = rows.len() as u32;
        let places = self.baked.lamp_places();
        self.uniforms.lamp_sixteens = light.1.div_ceil(16) as u32;
        rows.extend(rows_of_places(&places));
        self.uniforms.lobe_spiral = rows.len() as u32;
        let places = self.baked.lobe_places();
        self.uniforms.lobe_sixteens = (places.len() / 16) as u32;
        rows.extend(rows_of_places(&places));
        self.uniforms.levels = rows.len() as u32;
        self.uniforms.level_count = self.baked.lobe_levels().count() as u32;
        let mut first = self.uniforms.level_count as usize;
        for (cells, means) in self.baked.lobe_levels() {
            rows.push([first as f32, cells as f32, 0.0, 0.0]);
            first += means.len();
        }
        rows.extend(self.baked.lobe_levels().flat_map(|(_, means)| means).map(|mean| row(*mean, 0.0)));
        self.runner.write(TABLES, &rows)?;
        self.tables_of = Some(light);
        Ok(())
    }

    fn prepare_on_device(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        let arrays = self.baked.frame_arrays(frame)?;
        let placed = Placed { spheres: arrays.spheres, lamps: arrays.lamps };
        let space = placed.space(arrays.rotation, arrays.origin, arrays.boxes.iter().map(|placed| placed.center));
        let rows = rows_of_frame(&arrays, &placed, space.scale as f32);
        let spheres = arrays.spheres.len() as u32;
        let (boxes, lamps) = (arrays.boxes.len() as u32, arrays.lamps.len() as u32);
        let light = (arrays.light_changes, arrays.lamp_directions);
        let (irradiance, (constant, grid_cells)) = (node_rows(arrays.rest), constant_or_cells(arrays.rest));
        self.write_tables(light, &irradiance)?;
        self.uniforms = FrameUniforms {
            constant,
            eye: space.place(frame.scene.camera.eye.as_dvec3()).extend(0.0).as_vec4().to_array(),
            grid_cells,
            lamp_directions: light.1 as f32,
            sphere_count: spheres,
            box_count: boxes,
            lamp_count: lamps,
            boxes: PLACED_ROWS as u32 * spheres,
            lamps: PLACED_ROWS as u32 * spheres + 5 * boxes,
            ..self.uniforms
        };
        self.runner.write_uniforms(&self.uniforms);
        self.runner.write(ROWS, &rows)?;
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(())
    }
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint.parts.extend([("receivers on the device", receivers), ("tables and frame on the device", others)]);
        footprint
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        let points = self.baked.own_points(receivers);
        self.write_cells(&points)?;
        Ok(self.runner.place_receivers(frame, receivers, &|i| i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.prepare_on_device(frame)?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

/// Spheres, boxes and lamps, as `mask/frame.wgsl` tells.
fn rows_of_frame(arrays: &FrameArrays<'_>, placed: &Placed<'_>, scale: f32) -> Vec<[f32; 4]> {
    let boxes = arrays.boxes.iter().flat_map(|&PlacedBox { center, half, rotation, object }| {
        let [center, half] = [center, half].map(|vector| scale * Vec3::from(vector));
        let axes = rotation.map(|axis| row(axis.into(), 0.0));
        [row(center, object as f32), row(half, 0.0)].into_iter().chain(axes)
    });
    placed.sphere_rows(scale).chain(boxes).chain(placed.lamp_rows(scale)).collect()
}

/// Places of a spiral four by four.
fn rows_of_places(places: &[[f32; 3]]) -> impl Iterator<Item = [f32; 4]> {
    places.chunks(4).flat_map(|four| (0..3).map(|k| std::array::from_fn(|lane| four[lane][k])))
}

/// Reflectance of objects beside their diffuse part, as `mask/frame.wgsl` tells.
fn reflectances(scene: &Scene) -> Vec<u32> {
    let mut terms: Vec<Vec<Row>> = scene.objects.iter().map(|object| terms(&object.material.reflectance)).collect();
    // For what lies on no object.
    terms.push(Vec::new());
    let mut numbers = Vec::new();
    let mut first = 2 * terms.len();
    for of_object in &terms {
        numbers.extend([first as u32, (of_object.len() / TERM_ROWS) as u32]);
        first += 4 * of_object.len();
    }
    numbers.extend(terms.iter().flatten().flatten());
    numbers
}

/// Directions four by four, as `mask/frame.wgsl` tells.
fn rows_of_set(set: &SetArrays) -> Vec<[f32; 4]> {
    let mut rows = vec![[set.mean_sharpness, 0.0, 0.0, 0.0]];
    for four in set.directions.chunks(4) {
        rows.extend((0..4).map(|k| std::array::from_fn::<f32, 4, _>(|lane| four[lane].0[k])));
        rows.extend((0..3).map(|c| std::array::from_fn::<f32, 4, _>(|lane| four[lane].1[c])));
    }
    rows
}
