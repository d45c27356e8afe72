//! `prt` on the device: vectors and where receivers lie between them stay there, light goes up.
//!
//! A receiver on no triangle gets a row of its own when it is placed, of the light that an open sky would send it: kernels know no
//! spherical harmonics.

mod clusters;
mod too_large;

pub use clusters::{ClusterBetween, ClusterUniforms};

use crate::{
    kernels::{PRT, PRT_LAMPS},
    pipeline::flag,
    receivers::KernelSpace,
    reflectance::{TERM_ROWS, terms},
    rows::{in_fours, row},
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use clusters::ClusteredOnGpu;
use glam::{DMat3, Vec3};
use halfshade_scene::{Cache, Frame, Progress, Receivers, Reflectance, Scene};
use halfshade_sh::wgsl::MAX_WGSL_BANDS;
use halfshade_strategies::{
    Prt,
    prt::{
        BakedScene,
        arrays::{LocalLights, Place, SceneArrays},
        gloss_arrays::{GlossArrays, GlossPlace},
    },
};
use halfshade_strategy::{Baked, Detail, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use too_large::told;

/// Rows of four of the longest vector.
const MOST_PARTS: usize = 16;

/// Bands of a lobe before it is fitted.
const LOBE_BANDS: usize = 8;

/// [`Prt`], whose receivers are shaded on the device.
#[derive(Debug)]
pub struct PrtOnGpu {
    bench: Bench,
    strategy: Prt,
}

/// Light of a frame, as the shader reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/dot.wgsl`")]
pub struct FrameUniforms {
    pub light: [[[f32; 4]; MOST_PARTS]; 3],
    pub baked_from_world: [[f32; 4]; 3],
    pub eye: [f32; 4],
}

/// A receiver between vertices.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "fields are told of in `prt/dot.wgsl`")]
pub struct Between {
    pub rows: [u32; 3],
    pub fit: u32,
    pub weights: [f32; 3],
    pub terms: u32,
    pub matrices: [u32; 3],
    pub term_count: u32,
}

struct BakedOnGpu {
    baked: BakedScene,
    runner: Runner,
    /// Terms of the reflectance of every object.
    terms: Vec<Vec<[f32; 4]>>,
    has_lamps: bool,
}

impl PrtOnGpu {
    /// Keeps what takes rays in `cache`.
    pub(crate) fn new(bench: Bench, cache: Cache) -> Self {
        Self { bench, strategy: Prt::new(cache) }
    }
}

impl Strategy for PrtOnGpu {
    fn info(&self) -> Info {
        self.strategy.info()
    }

    fn needs_spheres(&self) -> bool {
        self.strategy.needs_spheres()
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let baked = self.strategy.bake_scene(scene, params, progress)?;
        if baked.has_movers() {
            let reason = "volumes of light have no kernel on the graphics device; take device `cpu`";
            return Err(StrategyError::Unsupported(reason.into()));
        }
        let SceneArrays { bands, channels, clusters, .. } = baked.scene_arrays();
        if let Some(missing) =
            baked.local_lights().and_then(|lights| without_kernel(&lights, bands, clusters.is_some()))
        {
            let reason =
                format!("local lights with {missing} have no kernel on the graphics device; take device `cpu`");
            return Err(StrategyError::Unsupported(reason));
        }
        if clusters.is_some() {
            if scene.is_glossy() {
                let reason = "gloss beside compressed transfer has no kernel on the graphics device; take device `cpu`";
                return Err(StrategyError::Unsupported(reason.into()));
            }
            return Ok(Box::new(ClusteredOnGpu::new(&self.bench, baked)?));
        }
        let constants = [
            ("PARTS", parts(bands) as f64),
            ("CHANNELS", channels as f64),
            ("BANDS", bands as f64),
            ("IS_GLOSSY", flag(scene.is_glossy())),
            ("LAMPS", scene.lights.len() as f64),
        ];
        let has_lamps = !scene.lights.is_empty();
        let (kernel, sh_bands) = if has_lamps { (&PRT_LAMPS, Some(bands)) } else { (&PRT, None) };
        let runner = Runner::new(&self.bench, kernel, sh_bands, &constants, size_of::<FrameUniforms>())?;
        let terms = scene.objects.iter().map(|object| term_rows(&object.material.reflectance)).collect();
        Ok(Box::new(BakedOnGpu { baked, runner, terms, has_lamps }))
    }
}

/// Settings of local lights that have no kernel, if there are any.
fn without_kernel(lights: &LocalLights, bands: usize, is_compressed: bool) -> Option<&'static str> {
    match () {
        () if lights.is_between_points => Some("lamp-steps"),
        () if lights.is_windowed => Some("a window"),
        () if is_compressed => Some("compression"),
        () if bands > MAX_WGSL_BANDS => Some("more than six bands"),
        () => None,
    }
}

/// Rows of four that a vector takes.
fn parts(bands: usize) -> usize {
    (bands * bands).div_ceil(4)
}

impl FrameUniforms {
    /// Light by channel and coefficient.
    pub fn new(light: &[Vec<f32>; 3]) -> Self {
        let mut uniforms = Self::zeroed();
        for (places, channel) in uniforms.light.iter_mut().zip(light) {
            places.iter_mut().zip(in_fours(channel)).for_each(|(place, four)| *place = four);
        }
        uniforms
    }
}

impl BakedOnGpu {
    /// Rows of the table and of those receivers that lie on no triangle, and where each receiver lies between them.
    fn rows(&self, frame: &Frame<'_>, receivers: Receivers<'_>) -> (Vec<[f32; 4]>, Vec<Between>) {
        let SceneArrays { bands, channels, rows, .. } = self.baked.scene_arrays();
        let per_row = channels * parts(bands);
        let mut fours: Vec<[f32; 4]> = rows.chunks_exact(bands * bands).flat_map(in_fours).collect();
        let mut points = Vec::with_capacity(receivers.len());
        for (i, place) in self.baked.places(receivers).enumerate() {
            let mut point = Between::default();
            match place {
                Place::Dark => {}
                Place::Between(between) => {
                    for (k, (row, weight)) in between.into_iter().enumerate() {
                        (point.rows[k], point.weights[k]) = ((row * per_row) as u32, weight);
                    }
                }
                Place::Open => {
                    (point.rows[0], point.weights[0]) = (fours.len() as u32, 1.0);
                    let vector = self.baked.open_vector(frame, receivers.normal_at(i));
                    (0..channels).for_each(|_| fours.extend(in_fours(&vector)));
                }
            }
            points.push(point);
        }
        if let Some(arrays) = self.baked.gloss_arrays() {
            self.add_gloss(&arrays, frame, receivers, &mut (&mut fours, &mut points));
        }
        (fours, points)
    }

    /// Adds fits, terms and matrices to the rows, and where glossy receivers find them.
    fn add_gloss(
        &self,
        arrays: &GlossArrays<'_>,
        frame: &Frame<'_>,
        receivers: Receivers<'_>,
        (rows, points): &mut (&mut Vec<[f32; 4]>, &mut Vec<Between>),
    ) {
        let SceneArrays { bands, channels, .. } = self.baked.scene_arrays();
        let fits = arrays.fits.each_ref().map(|fit| {
            let first = rows.len() as u32;
            rows.extend(fit_rows(bands, fit));
            first
        });
        let terms: Vec<[u32; 2]> = self
            .terms
            .iter()
            .map(|terms| {
                let first = rows.len() as u32;
                rows.extend(terms);
                [first, (terms.len() / TERM_ROWS) as u32]
            })
            .collect();
        let first = rows.len();
        let per_matrix = 2 + channels * bands * bands * parts(bands);
        let numbers = arrays.matrices.chunks_exact((channels * bands.pow(4)).max(1));
        arrays.frames.iter().zip(numbers).for_each(|(own, matrix)| rows.extend(matrix_rows(bands, own, matrix)));
        for (i, place) in self.baked.places(receivers).enumerate() {
            let point = &mut points[i];
            let fit = match self.baked.gloss_place(frame, &receivers, i, &place) {
                GlossPlace::Dull => continue,
                GlossPlace::Between(matrices, fit) => {
                    point.matrices = matrices.map(|matrix| (first + matrix * per_matrix) as u32);
                    fit
                }
                GlossPlace::Own(own, matrix, fit) => {
                    point.matrices[0] = rows.len() as u32;
                    rows.extend(matrix_rows(bands, &own, &matrix.repeat(channels)));
                    fit
                }
            };
            point.fit = fits[fit];
            [point.terms, point.term_count] = terms[receivers.object[i] as usize];
        }
    }
}

/// A matrix behind its frame.
fn matrix_rows(bands: usize, frame: &[Vec3; 2], matrix: &[f32]) -> Vec<[f32; 4]> {
    let frame = frame.map(|axis| row(axis, 0.0));
    frame.into_iter().chain(matrix.chunks_exact(bands * bands).flat_map(in_fours)).collect()
}

/// A fit in rows of four, eight factors for each degree and order below eight, whether there are any or not.
pub fn fit_rows(bands: usize, fit: &[f32]) -> Vec<[f32; 4]> {
    let mut rows = vec![[0.0; 4]; 2 * LOBE_BANDS * bands];
    let mut rest = fit;
    for (degree, order) in (0..bands).flat_map(|degree| (0..=degree).map(move |order| (degree, order))) {
        let (factors, after) = rest.split_at(LOBE_BANDS - order);
        rest = after;
        for (k, factor) in (order..).zip(factors) {
            rows[2 * (LOBE_BANDS * degree + order) + k / 4][k % 4] = *factor;
        }
    }
    rows
}

/// Terms of a reflectance; their models are told by numbers, since small whole numbers as bits would be lost.
fn term_rows(reflectance: &Reflectance) -> Vec<[f32; 4]> {
    let rows = terms(reflectance).into_iter().enumerate();
    rows.map(|(number, row)| {
        let [x, y, z, last] = row.map(f32::from_bits);
        [x, y, z, if number % TERM_ROWS == 1 { row[3] as f32 } else { last }]
    })
    .collect()
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let mut footprint = self.baked.footprint();
        let [receivers, others] = self.runner.bytes();
        footprint.parts.extend([("receivers on the device", receivers), ("vectors and light on the device", others)]);
        footprint
    }

    fn details(&self) -> Vec<Detail> {
        self.baked.details()
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        let (rows, points) = self.rows(frame, receivers);
        self.runner.write(1, &rows).map_err(told)?;
        self.runner.write(2, &points).map_err(told)?;
        Ok(self.runner.place_receivers(frame, receivers, &|i| i as u32)?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let mut uniforms = FrameUniforms::new(self.baked.frame_arrays(frame)?.light);
        let places = frame.world_from_object.iter().map(|pose| pose.translation.as_dvec3());
        // Receivers of local lights see them along the axes of the vectors.
        let baked_from_world = self.baked.baked_from_world().as_dmat3();
        let (rotation, rest) = match self.has_lamps {
            true => (baked_from_world, DMat3::IDENTITY),
            false => (DMat3::IDENTITY, baked_from_world),
        };
        let space = KernelSpace::of_points(places, rotation);
        uniforms.baked_from_world = rest.as_mat3().transpose().to_cols_array_2d().map(|axis| row(axis.into(), 0.0));
        if self.has_lamps {
            let lamps = frame
                .lights
                .iter()
                .flat_map(|light| [space.place_sphere(light.center, light.radius), row(light.radiance, 0.0)]);
            self.runner.write(3, &lamps.collect::<Vec<_>>()).map_err(told)?;
        }
        uniforms.eye = row(space.place(frame.scene.camera.eye.as_dvec3()).as_vec3(), 0.0);
        self.runner.write_uniforms(&uniforms);
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}
