//! Light without visibility: irradiance by normal and place.

use glam::{Mat3, Vec3};
use halfshade_scene::{
    Frame, SphereLight,
    light::{DirectionalCells, DistantLight, OctahedralGrid, Sun},
};
use rayon::prelude::*;
use std::f32::consts::PI;

/// The environment's irradiance over normals, in its own space.
#[derive(Debug)]
pub struct Irradiance {
    /// The environment without its sun.
    pub base: DistantLight,
    /// Nodes of the table.
    pub grid: OctahedralGrid,
    /// Irradiance at each node of the grid; empty for constant light.
    pub table: Vec<Vec3>,
}

/// The light of a frame, for receivers that see all of it.
#[derive(Debug)]
pub(crate) struct FrameIrradiance<'a> {
    distant: &'a Irradiance,
    sun: Option<Sun>,
    environment_from_world: Mat3,
    lights: Vec<SphereLight>,
}

impl Irradiance {
    /// That of `base`, with so many cells from the centre of the table to its side.
    pub fn new(base: &DistantLight, cells: usize) -> Self {
        let grid = OctahedralGrid::new(cells);
        let mut irradiance = Self { base: DistantLight::Constant(Vec3::ZERO), grid, table: Vec::new() };
        irradiance.set_base(base);
        irradiance
    }

    /// Makes it that of `base`; whether it was another one.
    pub fn set_base(&mut self, base: &DistantLight) -> bool {
        if self.base.is_same_as(base) {
            return false;
        }
        self.base = base.clone();
        self.table = match base {
            DistantLight::Constant(_) => Vec::new(),
            DistantLight::Map(map) => {
                let cells = DirectionalCells::new(map);
                let nodes = 0..self.grid.node_count();
                nodes.into_par_iter().map(|node| cells.irradiance(self.grid.direction(node))).collect()
            }
        };
        true
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.table.as_slice())
    }

    /// Irradiance at unit `normal` in the environment's space.
    pub(crate) fn at(&self, normal: Vec3) -> Vec3 {
        match &self.base {
            DistantLight::Constant(radiance) => PI * *radiance,
            DistantLight::Map(_) => {
                let found = self.grid.lookup(normal);
                (0..3).map(|k| found.weights[k] * self.table[found.nodes[k]]).sum()
            }
        }
    }
}

impl<'a> FrameIrradiance<'a> {
    pub(crate) fn new(distant: &'a Irradiance, frame: &Frame<'_>) -> Self {
        Self {
            distant,
            sun: frame.scene.environment.sun,
            environment_from_world: Mat3::from_quat(frame.world_from_environment.normalize().conjugate()),
            lights: frame.lights.clone(),
        }
    }

    /// Irradiance at a receiver with unit `normal`.
    pub(crate) fn at(&self, position: Vec3, normal: Vec3) -> Vec3 {
        self.parts(position, normal).sum()
    }

    /// The same light by light: of the environment without its sun, of the sun, of each local light.
    pub(crate) fn parts(&self, position: Vec3, normal: Vec3) -> impl Iterator<Item = Vec3> {
        let normal_in_environment = self.environment_from_world * normal;
        let sun = self.sun.map_or(Vec3::ZERO, |sun| sun.irradiance(normal_in_environment));
        let local = self.lights.iter().map(move |light| light.irradiance(position, normal));
        [self.distant.at(normal_in_environment), sun].into_iter().chain(local)
    }
}
