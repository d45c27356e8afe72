//! The infinitely distant environment: constant or a map, and a sun on top where there is one.

use super::EnvironmentMap;
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;

/// Distant light without its sun.
#[derive(Debug, Clone)]
pub enum DistantLight {
    /// The same radiance from everywhere.
    Constant(Vec3),
    /// An image around the scene.
    Map(Arc<EnvironmentMap>),
}

impl DistantLight {
    /// Whether both give the same radiance from everywhere; a shared map is not compared texel by texel.
    pub fn is_same_as(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Map(a), Self::Map(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

/// A sun: a small cap of constant radiance, kept apart from the map because no map resolves it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sun {
    /// Unit direction toward its centre.
    pub direction: Vec3,
    /// Angular radius in radians.
    pub angular_radius: f32,
    /// Radiance inside the cap, added to the map's.
    pub radiance: Vec3,
}

impl Sun {
    /// Irradiance on a surface of unit `normal` in environment space if nothing blocks: exact, cut by the horizon.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        let cos_angle = f64::from(self.direction.dot(normal));
        self.radiance * super::cap_irradiance(cos_angle, f64::from(self.angular_radius).sin()) as f32
    }
}

/// Infinitely distant light in environment space.
#[derive(Debug, Clone)]
pub struct Environment {
    /// The sky, the room: all but the sun.
    pub base: DistantLight,
    /// The sun, if there is one.
    pub sun: Option<Sun>,
}

impl Environment {
    /// The same radiance from everywhere.
    pub const fn constant(radiance: Vec3) -> Self {
        Self { base: DistantLight::Constant(radiance), sun: None }
    }

    /// An image around the scene.
    pub fn map(map: EnvironmentMap) -> Self {
        Self { base: DistantLight::Map(Arc::new(map)), sun: None }
    }

    /// Whether both give the same radiance from everywhere (see [`DistantLight::is_same_as`]).
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.sun == other.sun && self.base.is_same_as(&other.base)
    }

    /// The same light, `factor` times as strong.
    pub fn scaled(&self, factor: f32) -> Self {
        let base = match &self.base {
            DistantLight::Constant(radiance) => DistantLight::Constant(factor * *radiance),
            DistantLight::Map(map) => DistantLight::Map(Arc::new(map.scaled(factor))),
        };
        Self { base, sun: self.sun.map(|sun| Sun { radiance: factor * sun.radiance, ..sun }) }
    }

    /// Radiance that arrives along unit `direction` (pointing away from the receiver), sun included.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let base = match &self.base {
            DistantLight::Constant(radiance) => *radiance,
            DistantLight::Map(map) => map.radiance(direction),
        };
        match self.sun {
            // Chord instead of cosine: 1 - cos loses all digits of a small angular radius in f32.
            Some(sun) if direction.distance(sun.direction) <= 2.0 * (0.5 * sun.angular_radius).sin() => {
                base + sun.radiance
            }
            _ => base,
        }
    }
}
