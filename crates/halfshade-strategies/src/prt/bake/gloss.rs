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
    gloss_table::GlossTable,
    hemisphere::{Hemisphere, exact_bands, weights},
    passes::{DirectRow, Passes, add_row, set_bits},
    table::Transfer,
};
use crate::prt::kernel::dot::PADDING;
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::cache::CacheKey;
use halfshade_sh::{basis, hemisphere::Weight, rotation::ShRotation};
use halfshade_strategy::StrategyError;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Fills in the matrices of light that nothing hides.
pub(crate) fn open(mut table: GlossTable, points: &[(Vec3, Vec3)], bands: usize, channels: usize) -> GlossTable {
    let grams = [Weight::Cosine, Weight::Equal].map(|weight| weight.gram(bands));
    let matrix = |&(row, weight): &(usize, Weight)| {
        let (position, normal) = points[row];
        in_world(&grams[weight as usize], bands, &Hemisphere::frame(position, normal)).repeat(channels)
    };
    table.values = table.rows().par_iter().flat_map_iter(matrix).map(|value| value as f32).collect();
    finish(&mut table, points);
    table
}

/// Adds the frames, and what is read past the end.
fn finish(table: &mut GlossTable, points: &[(Vec3, Vec3)]) {
    let frame = |(row, _): (usize, Weight)| {
        let frame = Hemisphere::frame(points[row].0, points[row].1);
        [frame.z_axis, frame.x_axis].map(|axis| axis.as_vec3())
    };
    table.frames = table.rows().into_iter().map(frame).collect();
    table.values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    table.values.extend([0.0; PADDING]);
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
                let matrices = |&row: &(usize, Weight)| self.direct(row).repeat(channels);
                table.values = rows.par_iter().flat_map_iter(matrices).map(|value| value as f32).collect();
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
        finish(&mut table, self.passes.points);
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
                add_row(&mut sent, before, row, share, met.albedo);
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
