//! An environment in world space.

use crate::{
    cosine_lobe::{
        bake::environment::{FittedEnvironment, cells::FRAMES},
        kernel::{
            environment::{Cells8, Lobes8},
            square::Square,
        },
    },
    shared::vector::dot,
};
use glam::{Quat, Vec3};
use halfshade_sh::lobe::Lobe8;
use wide::f32x8;

/// Lobes and cells of an environment, turned into world space.
#[derive(Debug)]
pub(crate) struct Surroundings {
    /// Cells along a side of each square.
    pub(crate) side: usize,
    pub(crate) uniform: Vec3,
    pub(crate) lobes: Vec<Lobes8>,
    pub(crate) squares: [Square; 2],
    pub(crate) cells: [Vec<Cells8>; 2],
}

impl Surroundings {
    /// An environment, turned; `None` where there is no light.
    pub(crate) fn new(fitted: &FittedEnvironment, world_from_environment: Quat) -> Option<Self> {
        if fitted.lobes.is_empty() && fitted.uniform == Vec3::ZERO {
            return None;
        }
        let rotation = world_from_environment.normalize();
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (rotation * axis).to_array());
        let turn = |direction: [f32x8; 3]| -> [f32x8; 3] {
            std::array::from_fn(|i| dot(&columns.map(|column| f32x8::splat(column[i])), &direction))
        };
        let lobes = |lobes: &Lobes8| Lobes8 { lobe: Lobe8 { axis: turn(lobes.lobe.axis), ..lobes.lobe }, ..*lobes };
        let cells = |cells: &Cells8| Cells8 { direction: turn(cells.direction), ..*cells };
        Some(Self {
            side: fitted.side,
            uniform: fitted.uniform,
            lobes: fitted.lobes.iter().map(lobes).collect(),
            squares: FRAMES.map(|frame| Square::hemisphere(frame.map(|axis| (rotation * Vec3::from(axis)).to_array()))),
            cells: fitted.cells.each_ref().map(|half| half.iter().map(cells).collect()),
        })
    }
}
