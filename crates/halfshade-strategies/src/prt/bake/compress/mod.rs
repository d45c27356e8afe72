//! Compression of transfer vectors by clustered principal components [Sloan2003].
//!
//! ```text
//! T(x) ≈ m_c + Σ_k a_k(x) b_ck        T · l ≈ m_c · l + Σ_k a_k(x) (b_ck · l)
//! ```
//!
//! with a cluster c and weights a for each row x. Products of the light with means and axes are the same for all rows of a
//! cluster: a frame multiplies them once, and a vertex is one multiplication and addition for each component, and one for the mean,
//! instead of one for each number of its vector. The vectors of red, green and blue are one long row.
//!
//! One cluster makes principal components of all rows, no components make vector quantization.

mod local;
mod principal;
mod rounded;
mod seeds;
mod table;

use super::chunks::told;
use crate::prt::{
    kernel::{decode::Weights, dot::PADDING},
    settings::{Compression, Settings},
};
use halfshade_scene::{Cache, Progress, cache::CacheKey};
use halfshade_strategy::StrategyError;
use local::{Cluster, ROUNDS};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use table::Rows;

/// Version of cached data: raised whenever it would come out differently.
const VERSION: u32 = 1;

/// A table of transfer vectors, compressed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clusters {
    /// Weights of a row.
    pub(crate) components: usize,
    /// Number of the cluster of each row.
    pub(crate) of_row: Vec<u16>,
    /// Weights of each row.
    pub(crate) weights: Vec<f32>,
    /// Per cluster its mean and as many axes as there are weights, those that it lacks 0; zeros at the end, as in the table.
    pub(crate) vectors: Vec<f32>,
}

impl Clusters {
    /// Clusters of rows of so many numbers, if settings want any; read from the cache if they are known.
    ///
    /// # Errors
    /// Those of the cache.
    pub(crate) fn of(
        rows: &[f32],
        width: usize,
        settings: &Settings,
        cache: &Cache,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, StrategyError> {
        let (count, components) = match settings.compression {
            Compression::None => return Ok(None),
            Compression::Pca => (1, settings.components),
            Compression::Vq => (settings.clusters, 0),
            Compression::Cpca => (settings.clusters, settings.components),
        };
        let key =
            CacheKey::new("transfer-clusters", VERSION).value(&(rows, width as u64, count as u64, components as u64));
        let fits = |found: &Self| found.fits(rows.len() / width, width);
        progress.start("clusters of transfer", 2 * ROUNDS as u64);
        let (found, outcome) = cache
            .get_or_compute(&key, fits, || Ok(Self::new(&Rows::new(rows, width), count, components, progress)))
            .map_err(told)?;
        outcome.notes.iter().for_each(|note| progress.note(note));
        Ok(Some(found))
    }

    fn new(rows: &Rows, count: usize, components: usize, progress: &dyn Progress) -> Self {
        let clusters = local::clusters(rows, count, components, progress);
        let components = clusters.iter().map(|cluster| cluster.flat.axes.len()).max().unwrap_or(0);
        let width = rows.width();
        let vectors = clusters.iter().flat_map(|cluster| vectors(cluster, width, components));
        let mut found = Self {
            components,
            of_row: vec![0; rows.len()],
            weights: vec![0.0; rows.len() * components],
            vectors: vectors.chain([0.0; PADDING]).collect(),
        };
        for (number, cluster) in clusters.iter().enumerate() {
            let weights: Vec<Vec<f32>> = cluster.members.par_iter().map(|&row| weights(rows, row, cluster)).collect();
            for (&row, weights) in cluster.members.iter().zip(&weights) {
                found.of_row[row as usize] = number as u16;
                found.weights[row as usize * components..][..weights.len()].copy_from_slice(weights);
            }
        }
        found
    }

    /// Whether lengths and numbers are those of so many rows.
    fn fits(&self, rows: usize, width: usize) -> bool {
        let count = self.count(width);
        self.components <= width
            && self.of_row.len() == rows
            && self.weights.len() == rows * self.components
            && self.vectors.len() == count * (self.components + 1) * width + PADDING
            && self.of_row.iter().all(|&cluster| usize::from(cluster) < count)
            && [&self.weights, &self.vectors].into_iter().flatten().all(|value| value.is_finite())
    }

    /// Number of clusters, given the numbers of a row.
    pub(crate) fn count(&self, width: usize) -> usize {
        self.vectors.len().saturating_sub(PADDING) / ((self.components + 1) * width)
    }

    /// Clusters and weights of all rows.
    pub(crate) fn table(&self) -> Weights<'_> {
        Weights { components: self.components, of_row: &self.of_row, weights: &self.weights }
    }
}

/// The mean and axes of a cluster, and zeros for those that it lacks.
fn vectors(cluster: &Cluster, width: usize, components: usize) -> impl Iterator<Item = f32> {
    let lacking = (components - cluster.flat.axes.len()) * width;
    let vectors = std::iter::once(&cluster.flat.mean).chain(&cluster.flat.axes);
    vectors.flatten().map(|&value| value as f32).chain(std::iter::repeat_n(0.0, lacking))
}

/// `a_k = (x - m) · b_k`.
fn weights(rows: &Rows, row: u32, cluster: &Cluster) -> Vec<f32> {
    let along = |axis: &nalgebra::DVector<f64>| {
        let terms = rows.row(row).iter().zip(&cluster.flat.mean).zip(axis);
        terms.map(|((&x, mean), axis)| (f64::from(x) - mean) * axis).sum::<f64>() as f32
    };
    cluster.flat.axes.iter().map(along).collect()
}

#[cfg(test)]
mod tests;
