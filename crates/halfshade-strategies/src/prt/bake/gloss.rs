//! Transfer of glossy surfaces: a matrix per vertex instead of a vector, since what is sent out depends on the eye.
//!
//! ```text
//! M_ij(x) = ∫ h(n·ω) y_i(R^-1 ω) (V(x, ω) y_j(ω) + (1 - V(x, ω)) albedo(y) T_j(y)) dω
//! ```
//!
//! over the hemisphere about the normal, with h the cosine of modified Phong and Lafortune models, or 1 for the original Phong. Rows
//! are of the vertex's own frame R, in which a lobe is fitted to the hemisphere (`halfshade_sh::hemisphere`), columns of the
//! world, where light is: so they are symmetric in no case, and stored whole. Rays are those of the vectors, and so is what they meet: light that others send on is diffuse.
//! As with vectors, what is blocked is taken from the closed form.

use super::{
    hemisphere::{Hemisphere, exact_bands, weights},
    passes::{DirectRow, Passes, set_bits},
    rows::{Back, Rows},
    table::{PADDING, Transfer},
};
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::{Frame, Reflectance, cache::CacheKey};
use halfshade_sh::{basis, hemisphere::Weight, rotation::ShRotation};
use halfshade_strategy::StrategyError;
use rayon::prelude::*;
use std::{f64::consts::PI, ops::Range};

/// Bytes that matrices may take.
const MOST_BYTES: usize = 4 << 30;

/// Bands of lobes before they are fitted.
pub(crate) const LOBE_BANDS: usize = halfshade_sh::kernel::MAX_BANDS;

/// Matrices of the glossy objects of a scene.
#[derive(Debug, Default)]
pub(crate) struct GlossTable {
    /// By object; nothing for diffuse ones.
    pub(crate) objects: Vec<Option<GlossRows>>,
    /// The frame of each matrix: normal and tangent.
    pub(crate) frames: Vec<[Vec3; 2]>,
    /// Matrices of bands² rows of as many numbers, one per channel, and 7 zeros at the end.
    pub(crate) values: Vec<f32>,
}

/// Matrices of an object: those of its vertices, then of their backs.
#[derive(Debug, Clone)]
pub(crate) struct GlossRows {
    pub(crate) weight: Weight,
    first: usize,
    /// Rows of the table of vectors that they belong to.
    fronts: Range<usize>,
    backs: Range<usize>,
}

impl GlossRows {
    /// The matrix that belongs to a row of the table of vectors.
    pub(crate) fn at(&self, row: usize) -> usize {
        let place = if self.fronts.contains(&row) {
            row - self.fronts.start
        } else {
            self.fronts.len() + row.saturating_sub(self.backs.start)
        };
        self.first + place
    }
}

impl GlossTable {
    /// Which matrices there are to be, without any.
    ///
    /// # Errors
    /// If they would take too much memory.
    pub(crate) fn plan(
        frame: &Frame<'_>,
        rows: &Rows,
        bands: usize,
        channels: usize,
    ) -> Result<Option<Self>, StrategyError> {
        let mut table = Self::default();
        let mut count = 0;
        for (object, own) in frame.scene.objects.iter().zip(&rows.objects) {
            let vertices = object.mesh.positions.len();
            let backs = if let Back::Rows(first) = own.back { first..first + vertices } else { 0..0 };
            let found = object.material.is_glossy().then(|| GlossRows {
                weight: weight_of(&object.material.reflectance),
                first: count,
                fronts: own.first..own.first + vertices,
                backs,
            });
            count += found.as_ref().map_or(0, |rows| rows.fronts.len() + rows.backs.len());
            table.objects.push(found);
        }
        let bytes = count.saturating_mul(channels * bands.pow(4) * size_of::<f32>());
        if bytes > MOST_BYTES {
            return Err(StrategyError::Unsupported(format!(
                "glossy transfer of {count} vertices in {bands} bands would take {} MB, and {} is the most; take fewer bands, or mask or ray-traced",
                bytes >> 20,
                MOST_BYTES >> 20,
            )));
        }
        Ok(frame.scene.is_glossy().then_some(table))
    }

    /// The key of matrices of so many bounces, whose vectors have this one.
    pub(crate) fn key(&self, vectors: &CacheKey) -> CacheKey {
        let of_object = |rows: &Option<GlossRows>| rows.as_ref().map(|rows| rows.weight as u8);
        vectors.clone().bytes(b"matrices").value(&self.objects.iter().map(of_object).collect::<Vec<_>>())
    }

    /// Rows of the table of vectors that have matrices, in their order.
    fn rows(&self) -> Vec<(usize, Weight)> {
        let of_object = |rows: &GlossRows| {
            let weight = rows.weight;
            rows.fronts.clone().chain(rows.backs.clone()).map(move |row| (row, weight)).collect::<Vec<_>>()
        };
        self.objects.iter().flatten().flat_map(of_object).collect()
    }

    /// Fills in the matrices of light that nothing hides.
    pub(crate) fn open(mut self, points: &[(Vec3, Vec3)], bands: usize) -> Self {
        let grams = [Weight::Cosine, Weight::Equal].map(|weight| weight.gram(bands));
        let matrix = |&(row, weight): &(usize, Weight)| {
            let (position, normal) = points[row];
            in_world(&grams[weight as usize], bands, &Hemisphere::frame(position, normal))
        };
        self.values = self.rows().par_iter().flat_map_iter(matrix).map(|value| value as f32).collect();
        self.finish(points);
        self
    }

    fn finish(&mut self, points: &[(Vec3, Vec3)]) {
        let frame = |(row, _): (usize, Weight)| {
            let frame = Hemisphere::frame(points[row].0, points[row].1);
            [frame.z_axis, frame.x_axis].map(|axis| axis.as_vec3())
        };
        self.frames = self.rows().into_iter().map(frame).collect();
        self.values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
        self.values.extend([0.0; PADDING]);
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice()) + size_of_val(self.frames.as_slice())
    }
}

/// The part of a model that isn't a lobe.
fn weight_of(reflectance: &Reflectance) -> Weight {
    if let Reflectance::Phong { .. } = reflectance { Weight::Equal } else { Weight::Cosine }
}

/// The columns of a matrix over the vertex's frame, turned into the world, row by row.
pub(crate) fn in_world(matrix: &[f64], bands: usize, frame: &DMat3) -> Vec<f64> {
    // Rows of the rotation are the columns of its transpose.
    let rotation = ShRotation::new(bands, &frame.transpose().to_cols_array_2d());
    matrix.chunks_exact(bands * bands).flat_map(|row| rotation.apply(row)).collect()
}

/// Directions of the rays as matrices weigh them.
pub(crate) struct GlossPasses<'a> {
    pub(crate) passes: &'a Passes<'a>,
    pub(crate) direct: &'a [DirectRow],
    bands: usize,
    /// Basis functions along each direction.
    basis: Vec<f64>,
    /// By [`Weight`]: the closed form, and the weight of each direction.
    grams: [Vec<f64>; 2],
    weights: [Vec<f64>; 2],
}

impl<'a> GlossPasses<'a> {
    pub(crate) fn new(passes: &'a Passes<'a>, direct: &'a [DirectRow], bands: usize) -> Self {
        let count = passes.hemisphere.count();
        let directions: Vec<DVec3> = (0..count).map(|k| passes.hemisphere.direction(k)).collect();
        let balanced = |weight: Weight| {
            // Products of two functions of n bands have 2n - 1.
            let exact = weight.integrals(exact_bands(2 * bands - 1, count));
            let base: Vec<f64> =
                directions.iter().map(|direction| PI / count as f64 * weight.of(direction.z) / direction.z).collect();
            weights(&base, &exact, &directions)
        };
        Self {
            passes,
            direct,
            bands,
            basis: directions.iter().flat_map(|direction| basis::evaluate(bands, direction.to_array())).collect(),
            grams: [Weight::Cosine, Weight::Equal].map(|weight| weight.gram(bands)),
            weights: [Weight::Cosine, Weight::Equal].map(balanced),
        }
    }

    /// The matrices of light that arrives straight, and, with the vectors that others have `before` the last bounce, of light that they
    /// reflect. These take rays, and are kept under the key.
    pub(crate) fn fill(
        &self,
        mut table: GlossTable,
        channels: usize,
        reflected: Option<(&Transfer, &CacheKey)>,
    ) -> Result<GlossTable, StrategyError> {
        let rows = table.rows();
        match reflected {
            None => {
                table.values =
                    rows.par_iter().flat_map_iter(|&row| self.direct(row)).map(|value| value as f32).collect();
            }
            Some((before, key)) => {
                let width = channels * self.grams[0].len();
                let found = self.passes.chunks.of(
                    key,
                    rows.len(),
                    |row: &Vec<f32>| row.len() == width,
                    |number| {
                        let mut all = self.direct(rows[number]).repeat(channels);
                        self.add_reflected(&mut all, rows[number], before);
                        all.into_iter().map(|value| value as f32).collect()
                    },
                )?;
                table.values = found.into_iter().flatten().collect();
            }
        }
        table.finish(self.passes.points);
        Ok(table)
    }

    fn basis_at(&self, k: usize) -> &[f64] {
        let count = self.bands * self.bands;
        &self.basis[k * count..][..count]
    }

    /// The closed form less what is blocked.
    fn direct(&self, (row, weight): (usize, Weight)) -> Vec<f64> {
        let (position, normal) = self.passes.points[row];
        let blocked = &self.direct[row].blocked;
        let mut matrix = self.grams[weight as usize].clone();
        let count = self.bands * self.bands;
        // The lower triangle, then the other.
        for k in set_bits(blocked) {
            let (y, share) = (self.basis_at(k), self.weights[weight as usize][k]);
            for (i, row) in matrix.chunks_exact_mut(count).enumerate() {
                let factor = share * y[i];
                row[..=i].iter_mut().zip(y).for_each(|(sum, y)| *sum -= factor * y);
            }
        }
        for i in 0..count {
            (i + 1..count).for_each(|j| matrix[i * count + j] = matrix[j * count + i]);
        }
        in_world(&matrix, self.bands, &Hemisphere::frame(position, normal))
    }

    /// Adds `h y_i albedo T_j` of what blocked rays meet, channel by channel.
    fn add_reflected(&self, matrices: &mut [f64], (row, weight): (usize, Weight), before: &Transfer) {
        let point = self.passes.points[row];
        let frame = Hemisphere::frame(point.0, point.1);
        let count = self.bands * self.bands;
        let channels = matrices.len() / (count * count);
        for k in set_bits(&self.direct[row].blocked) {
            let Some(met) = self.passes.surfaces.reflector(point, self.passes.along(&frame, k)) else { continue };
            let mut sent = vec![0.0; channels * count];
            for (row, share) in met.rows {
                super::passes::add_row(&mut sent, before, row, share, met.albedo);
            }
            let (y, share) = (self.basis_at(k), self.weights[weight as usize][k]);
            for (matrix, sent) in matrices.chunks_exact_mut(count * count).zip(sent.chunks_exact(count)) {
                for (row, y) in matrix.chunks_exact_mut(count).zip(y) {
                    row.iter_mut().zip(sent).for_each(|(sum, sent)| *sum += share * y * sent);
                }
            }
        }
    }
}
