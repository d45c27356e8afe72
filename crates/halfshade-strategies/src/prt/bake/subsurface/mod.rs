//! Transfer of translucent objects \[Dachsbacher2017\]: light that enters at a vertex, less what the surface mirrors, and what the dipole
//! makes of that of all vertices.
//!
//! ```text
//! E_i(y) = 1/π ∫ F_t(η, n·ω) V(y, ω) y_i(ω) max(n·ω, 0) dω, and what surfaces reflect      T_i(x) = ∫ R_d(|x - y|) E_i(y) dA(y)
//! ```
//!
//! over the object's surface, E between vertices being linear. T takes the place of a diffuse vertex's vector, before each bounce: light
//! that passed below a surface is what others see of it. Beside the error of rays it has that of E between vertices.

mod dipole;
mod scatter;

use super::{
    chunks::Chunks,
    hemisphere::Hemisphere,
    rows::{ObjectRows, Rows},
    table::Transfer,
};
use dipole::{Dipole, transmittance};
use glam::DVec3;
use halfshade_scene::{Frame, cache::CacheKey};
use halfshade_strategy::StrategyError;
use scatter::Surface;
use std::ops::Range;

/// Translucent objects of a scene.
#[derive(Debug, Default)]
pub(crate) struct Media {
    objects: Vec<Medium>,
}

#[derive(Debug)]
struct Medium {
    /// Rows of its vertices.
    rows: Range<usize>,
    /// Directions, weighted by what enters.
    hemisphere: Hemisphere,
    surface: Surface,
}

impl Media {
    pub(crate) fn new(frame: &Frame<'_>, rows: &Rows, bands: usize, directions: usize) -> Self {
        let medium = |(number, of_object): (usize, &ObjectRows)| {
            let object = &frame.scene.objects[number];
            let medium = object.material.subsurface?;
            let own = of_object.first..of_object.first + object.mesh.positions.len();
            let is_known = |triangle: &&[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < own.len());
            let eta = f64::from(medium.refractive_index);
            Some(Medium {
                hemisphere: Hemisphere::through(bands, directions, |cosine| transmittance(eta, cosine)),
                surface: Surface {
                    dipoles: Dipole::of(&medium),
                    positions: rows.points[own.clone()].iter().map(|(position, _)| position.as_dvec3()).collect(),
                    triangles: object.mesh.triangles.iter().filter(is_known).copied().collect(),
                },
                rows: own,
            })
        };
        Self { objects: rows.objects.iter().enumerate().filter_map(medium).collect() }
    }

    /// Directions of a row, given those of surfaces that light doesn't enter.
    pub(crate) fn hemisphere<'a>(&'a self, row: usize, opaque: &'a Hemisphere) -> &'a Hemisphere {
        let own = self.objects.iter().find(|medium| medium.rows.contains(&row));
        own.map_or(opaque, |medium| &medium.hemisphere)
    }

    /// Number of rows of all translucent objects.
    pub(crate) fn row_count(&self) -> usize {
        self.objects.iter().map(|medium| medium.rows.len()).sum()
    }

    /// Makes transfer of what enters translucent objects that of what leaves them. It has as many channels then as are asked for.
    ///
    /// # Errors
    /// Those of the cache.
    pub(crate) fn scatter(
        &self,
        transfer: &mut Transfer,
        channels: usize,
        chunks: &Chunks<'_>,
        key: &CacheKey,
    ) -> Result<(), StrategyError> {
        if self.objects.is_empty() {
            return Ok(());
        }
        transfer.repeat_channels(channels);
        let width = transfer.width();
        for (number, medium) in self.objects.iter().enumerate() {
            let key = key.clone().bytes(b"scattered").value(&(number as u64, channels as u64));
            let entered = &transfer.values[medium.rows.start * width..medium.rows.end * width];
            let row = |vertex: usize| medium.leaving(vertex, entered, width, channels);
            let rows = chunks.of(&key, medium.rows.len(), |row: &Vec<f32>| row.len() == width, row)?;
            let place = medium.rows.start * width;
            let leaving = rows.into_iter().flatten();
            transfer.values[place..].iter_mut().zip(leaving).for_each(|(value, leaving)| *value = leaving);
        }
        Ok(())
    }
}

impl Medium {
    /// Vectors of what leaves at a vertex, given those of what enters at all.
    fn leaving(&self, vertex: usize, entered: &[f32], width: usize, channels: usize) -> Vec<f32> {
        let mut sum = vec![0.0_f64; width];
        for (weight, row) in
            self.surface.weights(self.surface.positions[vertex]).iter().zip(entered.chunks_exact(width))
        {
            if *weight == DVec3::ZERO {
                continue;
            }
            let vectors = sum.chunks_exact_mut(width / channels).zip(row.chunks_exact(width / channels));
            for (channel, (sum, row)) in vectors.enumerate() {
                sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight[channel] * f64::from(*value));
            }
        }
        sum.into_iter().map(|value| value as f32).collect()
    }
}
