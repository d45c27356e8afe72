//! Spheres, lamps and distant light of a frame, in light space, as kernels of several methods read them.

use crate::{receivers::KernelSpace, rows::row};
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::light::DistantLight;
use halfshade_strategies::{
    mask::arrays::{BlockingSphere, Lamp, LampPlace},
    unshadowed::Irradiance,
};
use std::f32::consts::PI;

/// Rows of a sphere, and of a lamp.
pub(crate) const PLACED_ROWS: usize = 2;

/// Spheres and lamps in light space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed<'a> {
    pub(crate) spheres: &'a [BlockingSphere],
    pub(crate) lamps: &'a [Lamp],
}

impl Placed<'_> {
    /// Light space about an origin, scaled so that everything has coordinates near 1; beside these lie points at `others`.
    pub(crate) fn space(&self, rotation: DMat3, origin: DVec3, others: impl Iterator<Item = [f32; 3]>) -> KernelSpace {
        let reach = |center: [f32; 3], radius: f32| center.map(|x| x.abs() + radius).into_iter().fold(0.0, f32::max);
        let spheres = self.spheres.iter().map(|sphere| reach(sphere.center, sphere.radius));
        let lamps = self.lamps.iter().map(|lamp| match lamp.place {
            LampPlace::Far { .. } => 0.0,
            LampPlace::Near { center, .. } => reach(center, 0.0),
        });
        let extent = spheres.chain(lamps).chain(others.map(|center| reach(center, 0.0))).fold(0.0, f32::max);
        KernelSpace::around(origin, rotation, f64::from(extent))
    }

    /// Rows of each sphere: centre and radius, then the object.
    pub(crate) fn sphere_rows(&self, scale: f32) -> impl Iterator<Item = [f32; 4]> {
        self.spheres.iter().flat_map(move |sphere| {
            [row(scale * Vec3::from(sphere.center), scale * sphere.radius), [sphere.object as f32, 0.0, 0.0, 0.0]]
        })
    }

    /// Rows of each lamp: centre and radius of a sphere or direction and sine of a sun, then radiance and 1 for a sphere.
    pub(crate) fn lamp_rows(&self, scale: f32) -> impl Iterator<Item = [f32; 4]> {
        self.lamps.iter().flat_map(move |&Lamp { place, radiance }| match place {
            LampPlace::Far { direction, sine } => [row(direction.into(), sine), row(radiance, 0.0)],
            LampPlace::Near { center, radius } => [row(scale * Vec3::from(center), scale * radius), row(radiance, 1.0)],
        })
    }
}

/// Irradiance of constant light, and the cells of the table of a map's: one of both is 0.
pub(crate) fn constant_or_cells(rest: &Irradiance) -> ([f32; 4], f32) {
    match &rest.base {
        DistantLight::Constant(radiance) => (row(PI * *radiance, 0.0), 0.0),
        DistantLight::Map(_) => ([0.0; 4], rest.grid.cells() as f32),
    }
}

/// Irradiance at the nodes of the table.
pub(crate) fn node_rows(rest: &Irradiance) -> Vec<[f32; 4]> {
    rest.table.iter().map(|value| row(*value, 0.0)).collect()
}
