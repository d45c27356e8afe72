//! An occlusion field as it is projected [Tamura2006, 3.1]: every shell at the full resolution, in full precision.

use super::{
    basis::Basis,
    bounds::BoundingSphere,
    grid::{Grid, direction, place},
    solid::Solid,
};
use crate::shared::triangle_rays::TriangleRays;
use glam::Vec3;
use halfshade_scene::Progress;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Where sample points lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct ShellLayout {
    pub(crate) count: usize,
    /// Shells within the first, each of half the radius of the next: the paper has none.
    pub(crate) inner: u32,
    /// Sample points along longitude, as along latitude.
    pub(crate) resolution: usize,
    /// Distance between shells, and the radius of the first, in radii of the object's bounding sphere: 0.2 in
    /// [Tamura2006, 6].
    pub(crate) spacing: f32,
    /// Whether points within a solid are moved out of it; the paper has them blocked.
    pub(crate) leaves_solids: bool,
}

impl ShellLayout {
    /// Radii of the shells from the inside, in radii of the object, without the centre.
    pub(crate) fn radii(&self) -> Vec<f32> {
        let halved = (1..=self.inner).rev().map(|times| self.spacing * 0.5_f32.powi(times as i32));
        halved.chain((1..=self.count).map(|number| self.spacing * number as f32)).collect()
    }

    /// Distance of which all radii are multiples, in radii of the object.
    pub(crate) fn step(&self) -> f32 {
        self.spacing * 0.5_f32.powi(self.inner as i32)
    }

    /// Number of shells.
    pub(crate) fn len(&self) -> usize {
        self.count + self.inner as usize
    }
}

/// Vectors at every sample point around one mesh.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct ProjectedField<V> {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    pub(crate) layout: ShellLayout,
    pub(crate) radii: Vec<f32>,
    /// The first is the centre: one point.
    pub(crate) shells: Vec<Grid<V>>,
}

impl<V: Clone + Send + Sync> ProjectedField<V> {
    /// The field of a mesh in `bounds`.
    pub(crate) fn new<B: Basis<Vector = V>>(
        basis: &B,
        (rays, bounds): (&TriangleRays, BoundingSphere),
        layout: ShellLayout,
        progress: &dyn Progress,
    ) -> Self {
        let solid = Solid::new(rays, bounds);
        let radii: Vec<f32> = std::iter::once(0.0).chain(layout.radii()).collect();
        let grid = |number: usize| {
            let resolution = if number == 0 { 1 } else { layout.resolution };
            // As far as the next shell.
            let reach = bounds.radius * (radii.get(number + 1).unwrap_or(&radii[number]) - radii[number]);
            let sample = |sample| {
                let point = bounds.center + radii[number] * bounds.radius * direction(place(resolution, sample));
                match layout.leaves_solids {
                    true => solid.blocked_near(basis, point, reach),
                    false => basis.blocked_from(rays, point, bounds),
                }
            };
            let samples = (0..resolution * resolution).into_par_iter().map(sample).collect();
            progress.advance(u64::from(number > 0));
            Grid { resolution, samples }
        };
        let shells = (0..radii.len()).into_par_iter().map(grid).collect();
        Self { center: bounds.center, radius: bounds.radius, layout, radii, shells }
    }
}

impl<V> ProjectedField<V> {
    /// Whether it is sampled so around `bounds`, and has all its vectors.
    pub(crate) fn fits(&self, bounds: BoundingSphere, layout: ShellLayout, is_vector: impl Fn(&V) -> bool) -> bool {
        let resolution = |number: usize| if number == 0 { 1 } else { layout.resolution };
        let is_grid = |(number, grid): (usize, &Grid<V>)| {
            grid.resolution == resolution(number) && grid.samples.len() == grid.resolution * grid.resolution
        };
        (BoundingSphere { center: self.center, radius: self.radius }, self.layout) == (bounds, layout)
            && self.radii.iter().copied().eq(std::iter::once(0.0).chain(layout.radii()))
            && self.shells.len() == self.radii.len()
            && self.shells.iter().enumerate().all(is_grid)
            && self.shells.iter().flat_map(|grid| &grid.samples).all(is_vector)
    }
}
