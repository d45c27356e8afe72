//! Rays from the points of a grid.

use super::light::{Volume, identity};
use crate::prt::{
    bake::{
        chunks::Chunks,
        surface::{Met, Reflector, Surfaces},
        table::Transfer,
    },
    kernel::{
        dot::PADDING,
        grid::Grid,
        volume::{BANDS, COEFFICIENTS},
    },
};
use glam::{DVec3, Vec3};
use halfshade_scene::cache::CacheKey;
use halfshade_sh::basis;
use halfshade_strategy::StrategyError;
use std::f64::consts::PI;

/// Part of all directions in which a point within a solid meets it from within, at least.
const INSIDE: f64 = 0.1;

/// Points of a grid among surfaces.
pub(crate) struct Probes<'a> {
    pub(crate) grid: Grid,
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) chunks: &'a Chunks<'a>,
    /// Rays from each point.
    pub(crate) directions: usize,
    pub(crate) bands: usize,
}

/// Vectors of a point, and the part of directions that meet a solid from within.
type Probe = (Vec<f32>, f64);

impl Probes<'_> {
    /// The volume, given the transfer of surfaces, if they reflect anything.
    pub(crate) fn volume(
        &self,
        key: &CacheKey,
        reflected: Option<&Transfer>,
        channels: usize,
    ) -> Result<Volume, StrategyError> {
        let directions = self.directions();
        let length = COEFFICIENTS * channels * self.bands * self.bands;
        let fits = |probe: &Probe| probe.0.len() == length;
        let probe = |number| self.probe(self.grid.point(number), &directions, reflected, channels);
        let probes = self.chunks.of(key, self.grid.len(), fits, probe)?;
        let is_inside: Vec<bool> = probes.iter().map(|(_, inside)| *inside > INSIDE).collect();
        let inside = is_inside.iter().filter(|is_inside| **is_inside).count();
        let mut points: Vec<Option<Vec<f32>>> =
            probes.into_iter().zip(&is_inside).map(|((values, _), inside)| (!inside).then_some(values)).collect();
        fill(&self.grid, &mut points);
        let nothing = || vec![0.0; length];
        let vectors = points.into_iter().flat_map(|point| point.unwrap_or_else(nothing)).chain([0.0; PADDING]);
        let vectors = vectors.map(|value| if value.is_finite() { value } else { 0.0 });
        Ok(Volume { grid: self.grid, channels, vectors: vectors.collect(), inside, own: Vec::new() })
    }

    /// Directions in equal shares of the sphere, on a spiral.
    fn directions(&self) -> Vec<DVec3> {
        let step = PI * (3.0 - 5.0_f64.sqrt());
        let direction = |k: usize| {
            let height = 1.0 - (2 * k + 1) as f64 / self.directions as f64;
            let (sin, cos) = (k as f64 * step).sin_cos();
            let across = (1.0 - height * height).sqrt();
            DVec3::new(across * cos, across * sin, height)
        };
        (0..self.directions).map(direction).collect()
    }

    /// Vectors of light that arrives at a point, and the part of directions that meet a solid from within.
    fn probe(&self, point: Vec3, directions: &[DVec3], reflected: Option<&Transfer>, channels: usize) -> Probe {
        let count = self.bands * self.bands;
        let mut rows: Vec<f64> =
            identity(self.bands).chunks_exact(count).flat_map(|row| row.repeat(channels)).map(f64::from).collect();
        let mut inside = 0;
        let weight = 4.0 * PI / directions.len() as f64;
        for direction in directions {
            let along = direction.as_vec3().normalize_or(Vec3::Z);
            let Some(met) = self.surfaces.met((point, along), along) else { continue };
            let y = basis::evaluate(self.bands.max(BANDS), direction.to_array());
            // Light that is hidden, less light that comes instead.
            let mut hidden: Vec<f64> = y[..count].repeat(channels);
            match (met, reflected) {
                (Met::Inside, _) => inside += 1,
                (Met::Reflector(reflector), Some(transfer)) => subtract(&mut hidden, &reflector, transfer),
                (Met::Reflector(_) | Met::Dark, _) => {}
            }
            for (row, y) in rows.chunks_exact_mut(channels * count).zip(&y[..COEFFICIENTS]) {
                row.iter_mut().zip(&hidden).for_each(|(value, hidden)| *value -= weight * y * hidden);
            }
        }
        (rows.into_iter().map(|value| value as f32).collect(), f64::from(inside) / directions.len() as f64)
    }
}

/// Takes what a surface reflects, channel by channel.
fn subtract(hidden: &mut [f64], reflector: &Reflector, transfer: &Transfer) {
    let count = transfer.bands * transfer.bands;
    for (channel, hidden) in hidden.chunks_exact_mut(count).enumerate() {
        for (row, share) in reflector.rows {
            let factor = share * f64::from(reflector.albedo[channel]);
            let vector = transfer.vector(row, channel);
            hidden.iter_mut().zip(vector).for_each(|(hidden, &value)| *hidden -= factor * f64::from(value));
        }
    }
}

/// Gives points that have nothing the mean of their neighbours that have something, layer by layer.
fn fill(grid: &Grid, points: &mut [Option<Vec<f32>>]) {
    loop {
        let mean = |number: usize| -> Option<(usize, Vec<f32>)> {
            let known: Vec<&Vec<f32>> = grid.neighbours(number).filter_map(|other| points[other].as_ref()).collect();
            let mut mean = vec![0.0; known.first()?.len()];
            let share = 1.0 / known.len() as f32;
            known
                .iter()
                .for_each(|values| mean.iter_mut().zip(*values).for_each(|(mean, value)| *mean += share * value));
            Some((number, mean))
        };
        let layer: Vec<_> = (0..points.len()).filter(|&number| points[number].is_none()).filter_map(mean).collect();
        if layer.is_empty() {
            return;
        }
        layer.into_iter().for_each(|(number, mean)| points[number] = Some(mean));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_solids_take_their_neighbours_light() {
        let grid = Grid::around([Vec3::ZERO, Vec3::splat(4.0)], 4);
        let light = |number: usize| vec![grid.point(number).x];
        let mut points: Vec<_> = (0..grid.len()).map(|number| Some(light(number))).collect();
        // A block of three points each way about the middle.
        let is_inside = |number: usize| (grid.point(number) - 2.0).abs().max_element() < 1.5;
        (0..grid.len()).filter(|&number| is_inside(number)).for_each(|number| points[number] = None);
        fill(&grid, &mut points);
        for (number, found) in points.iter().enumerate() {
            let found = found.as_ref().unwrap()[0];
            let x = grid.point(number).x;
            let is_near = if is_inside(number) { (found - 2.0) * (x - 2.0) >= -1e-6 } else { found == x };
            assert!(is_near && (0.0..=4.0).contains(&found), "{x} {found}");
        }
        let mut none = vec![None; grid.len()];
        fill(&grid, &mut none);
        assert!(none.iter().all(Option::is_none));
    }
}
