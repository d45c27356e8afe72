//! Matrices of glossy objects: which there are, and where.

use super::rows::{Back, Rows};
use glam::Vec3;
use halfshade_scene::{Frame, Reflectance, cache::CacheKey};
use halfshade_sh::hemisphere::Weight;
use halfshade_strategy::StrategyError;
use std::ops::Range;

/// Bytes that matrices may take.
const MOST_BYTES: usize = 4 << 30;

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
    pub(crate) fn rows(&self) -> Vec<(usize, Weight)> {
        let of_object = |rows: &GlossRows| {
            let weight = rows.weight;
            rows.fronts.clone().chain(rows.backs.clone()).map(move |row| (row, weight)).collect::<Vec<_>>()
        };
        self.objects.iter().flatten().flat_map(of_object).collect()
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice()) + size_of_val(self.frames.as_slice())
    }
}

/// The part of a model that isn't a lobe.
fn weight_of(reflectance: &Reflectance) -> Weight {
    if let Reflectance::Phong { .. } = reflectance { Weight::Equal } else { Weight::Cosine }
}
