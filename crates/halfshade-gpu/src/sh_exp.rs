//! `sh-exp` on the device: shadows.

use crate::{
    kernels::SH_EXP,
    receivers::KernelSpace,
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use halfshade_scene::{
    Frame, Progress, Receivers, Scene,
    spheres::{AdjustRule, COVER_HEIGHT, FADE_HEIGHT},
};
use halfshade_sh::{
    blocker_table::INTERVALS,
    exponential::{MAX_SQUARINGS, SERIES_MAGNITUDE},
    wgsl::MAX_WGSL_BANDS,
};
use halfshade_strategies::{
    ShExp,
    sh_exp::{
        BakedScene,
        arrays::{BaseByNormal, Blocker, CombinationArrays, DistantLightByNormal, SceneArrays},
    },
};
use halfshade_strategy::{Baked, Footprint, Info, Params, Prepared, Strategy, StrategyError};

/// [`ShExp`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct ShExpOnGpu {
    bench: Bench,
}

/// A sphere, as `sh_exp/frame.wgsl` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct DeviceBlocker {
    pub(crate) center: [f32; 3],
    pub(crate) radius: f32,
    pub(crate) factors: [f32; 8],
}

/// Settings of a frame, as `sh_exp/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
pub(crate) struct FrameUniforms {
    pub(crate) cosine: [f32; 8],
    pub(crate) light: [f32; 4],
    pub(crate) sun_direction: [f32; 4],
    pub(crate) sun_perpendicular: [f32; 4],
    pub(crate) exponential_table: u32,
    pub(crate) light_table: u32,
    pub(crate) sun_table: u32,
    pub(crate) light_channels: u32,
    pub(crate) exponential_last: f32,
    pub(crate) exponential_limit: f32,
    pub(crate) exponential_per_magnitude: f32,
    pub(crate) grid_cells: f32,
}

struct BakedOnGpu {
    baked: BakedScene,
    runner: Runner,
    /// Changes of the light up to which tables are on the device.
    light_changes: Option<u32>,
}

/// All tables in one buffer, and where in it they begin.
#[derive(Debug, Default)]
struct Tables {
    rows: Vec<[f32; 4]>,
    uniforms: FrameUniforms,
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
        let (bands, constants) = (arrays.bands, constants(&arrays));
        let runner = Runner::new(&self.bench, &SH_EXP, Some(bands), &constants, size_of::<FrameUniforms>())?;
        Ok(Box::new(BakedOnGpu { baked, runner, light_changes: None }))
    }
}

/// The wish of the scene or the settings that has no kernel, and what to do instead.
fn missing(arrays: &SceneArrays<'_>) -> Option<&'static str> {
    match arrays.combination {
        CombinationArrays::Shares => return Some("exp=shares; take exp=hybrid, or device `cpu`"),
        CombinationArrays::Traced => return Some("exp=traced; take exp=hybrid, or device `cpu`"),
        CombinationArrays::Exponential(_) | CombinationArrays::Product => {}
    }
    if arrays.bands > MAX_WGSL_BANDS {
        return Some("more than 6 bands; take fewer, or device `cpu`");
    }
    if arrays.reflects {
        return Some("reflections; take bounces=0, or device `cpu`");
    }
    arrays.sees_ground.then_some("ground=seen; take ground=ignored, or device `cpu`")
}

/// Values of the kernel's `override`s.
fn constants(arrays: &SceneArrays<'_>) -> Vec<(&'static str, f64)> {
    let (rule, full_height) = match arrays.rule {
        AdjustRule::Continuous => (0.0, FADE_HEIGHT),
        AdjustRule::Covering => (1.0, COVER_HEIGHT),
        AdjustRule::Published => (2.0, 1.0),
    };
    let mut constants = vec![
        ("RULE", rule),
        ("FULL_HEIGHT", full_height),
        ("IS_CLAMPED", f64::from(u8::from(arrays.clamp))),
        ("INTERVALS", INTERVALS as f64),
        ("MAX_SQUARINGS", f64::from(MAX_SQUARINGS)),
    ];
    match arrays.combination {
        CombinationArrays::Exponential(exponential) => {
            let parts = exponential.parts();
            let method = match (parts.is_linear, parts.series_terms) {
                (true, _) => 2.0,
                (false, None) => 1.0,
                (false, Some(_)) => 0.0,
            };
            let limit = if parts.magnitude_limit.is_finite() { f64::from(parts.magnitude_limit) } else { -1.0 };
            constants.extend([
                ("METHOD", method),
                ("TERMS", f64::from(parts.series_terms.unwrap_or(1))),
                ("MAGNITUDE_LIMIT", limit),
                ("IS_BLENDED", f64::from(u8::from(parts.is_blended))),
                ("SERIES_MAGNITUDE", SERIES_MAGNITUDE),
            ]);
        }
        _ => constants.push(("IS_PRODUCT", 1.0)),
    }
    constants
}

impl Tables {
    fn of(arrays: &SceneArrays<'_>, light: &DistantLightByNormal) -> Self {
        let mut tables = Self::default();
        let Self { rows, uniforms } = &mut tables;
        rows.extend(arrays.blockers.rows().flat_map(|row| row.as_chunks::<4>().0.to_vec()));
        uniforms.exponential_table = rows.len() as u32;
        if let CombinationArrays::Exponential(exponential) = arrays.combination {
            let parts = exponential.parts();
            rows.extend(parts.table);
            uniforms.exponential_last = parts.table.len().saturating_sub(1) as f32;
            uniforms.exponential_limit = parts.table_limit;
            uniforms.exponential_per_magnitude = parts.entries_per_magnitude;
        }
        uniforms.light_table = rows.len() as u32;
        uniforms.grid_cells = light.grid.cells() as f32;
        let used = (arrays.bands * arrays.bands).div_ceil(4);
        match &light.base {
            BaseByNormal::Constant(radiance) => uniforms.light = radiance.extend(0.0).to_array(),
            BaseByNormal::Table { rows: eights, channels } => {
                uniforms.light_channels = *channels as u32;
                // Rows of eight are filled up with zeros; rows of four need fewer of them.
                for vector in eights.chunks_exact((arrays.bands * arrays.bands).div_ceil(8)) {
                    let values: Vec<f32> = vector.iter().flat_map(|eight| eight.to_array()).collect();
                    rows.extend(&values.as_chunks::<4>().0[..used]);
                }
            }
        }
        uniforms.sun_table = rows.len() as u32;
        if let Some(sun) = &light.sun {
            let [x, y, z] = sun.direction;
            uniforms.sun_direction = [x, y, z, 0.0];
            let [r, g, b] = sun.perpendicular;
            uniforms.sun_perpendicular = [r, g, b, sun.sin_radius as f32];
            let filled = sun.basis.chunks(4).map(|four| std::array::from_fn(|k| four.get(k).copied().unwrap_or(0.0)));
            rows.extend(filled);
        }
        for (value, cosine) in uniforms.cosine.iter_mut().zip(&light.cosine) {
            *value = *cosine;
        }
        tables
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
        self.baked.prepare_frame(frame)?;
        let cuts = self.baked.cut_of(receivers);
        Ok(self.runner.place_receivers(frame, receivers, &|i| cuts.as_ref().map_or(0, |cuts| cuts[i]))?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.baked.prepare_frame(frame)?;
        let arrays = self.baked.frame_arrays();
        let spheres = || self.baked.cuts().flatten();
        let extent = spheres().flat_map(|b| b.center.iter().map(|c| c.abs() + b.radius)).fold(0.0, f32::max);
        let space = KernelSpace::around(arrays.center, arrays.rotation, f64::from(extent));
        let blockers: Vec<DeviceBlocker> = spheres().map(|blocker| scaled(blocker, space.scale)).collect();
        let mut first = 0;
        let cut = |blockers: &[Blocker]| {
            first += blockers.len() as u32;
            [first - blockers.len() as u32, blockers.len() as u32]
        };
        let cuts: Vec<[u32; 2]> = self.baked.cuts().map(cut).collect();
        let changes = Some(arrays.light_changes);
        if self.light_changes != changes {
            let tables = Tables::of(&self.baked.scene_arrays(), arrays.light);
            self.runner.write_uniforms(&tables.uniforms);
            self.runner.write(3, &tables.rows)?;
            self.light_changes = changes;
        }
        self.runner.write(1, &blockers)?;
        self.runner.write(2, &cuts)?;
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

fn scaled(blocker: &Blocker, scale: f64) -> DeviceBlocker {
    DeviceBlocker {
        center: blocker.center.map(|c| (f64::from(c) * scale) as f32),
        radius: (f64::from(blocker.radius) * scale) as f32,
        factors: blocker.factors,
    }
}
