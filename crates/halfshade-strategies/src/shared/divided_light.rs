//! Distant light in two parts: lamps, which are handled as caps of constant radiance, and everything else.

use super::{irradiance::Irradiance, lamps};
use glam::Vec3;
use halfshade_scene::{
    Environment,
    light::{DistantLight, EnvironmentMap, Sun},
};
use std::sync::Arc;

/// Cells of the table of irradiance over normals, from its centre to its side.
const NORMAL_CELLS: usize = 32;

/// An environment without its sun, in its own space, less the lamps that a map holds.
#[derive(Debug)]
pub(crate) struct DividedLight {
    /// As it was given.
    whole: DistantLight,
    most_lamps: usize,
    /// Small bright parts of a map.
    lamps: Vec<Sun>,
    /// Light that is left, with its irradiance over normals.
    pub(crate) rest: Irradiance,
}

impl DividedLight {
    /// Splits off at most so many lamps.
    pub(crate) fn new(whole: &DistantLight, most_lamps: usize) -> Self {
        let (lamps, rest) = divided(whole, most_lamps);
        Self { whole: whole.clone(), most_lamps, lamps, rest: Irradiance::new(&rest, NORMAL_CELLS) }
    }

    /// Makes it that of `whole`; whether it was another one.
    pub(crate) fn set(&mut self, whole: &DistantLight) -> bool {
        if self.whole.is_same_as(whole) {
            return false;
        }
        let (lamps, rest) = divided(whole, self.most_lamps);
        (self.whole, self.lamps) = (whole.clone(), lamps);
        self.rest.set_base(&rest);
        true
    }

    /// The lamps, and the sun of `environment` if it has one, in the environment's space.
    pub(crate) fn suns(&self, environment: &Environment) -> impl Iterator<Item = Sun> {
        environment.sun.into_iter().chain(self.lamps.iter().copied())
    }

    pub(crate) fn bytes(&self) -> usize {
        self.rest.bytes()
    }
}

/// At most so many lamps of a distant light, and the rest.
pub(crate) fn divided(whole: &DistantLight, most_lamps: usize) -> (Vec<Sun>, DistantLight) {
    let DistantLight::Map(map) = whole else { return (Vec::new(), whole.clone()) };
    let (lamps, texels) = lamps::split(map, most_lamps);
    if lamps.is_empty() {
        return (lamps, whole.clone());
    }
    let texels = texels.into_iter().map(Vec3::from).collect();
    // As many texels as the map has.
    let rest = EnvironmentMap::new(map.width(), map.height(), texels).unwrap_or_else(|| (**map).clone());
    (lamps, DistantLight::Map(Arc::new(rest)))
}
