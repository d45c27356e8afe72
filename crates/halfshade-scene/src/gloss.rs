//! Gloss that varies over a surface.

use crate::Texture;
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;

/// Factors in [0, 1] by which a point of a surface differs from its material: the material states the largest specular
/// scale and exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gloss {
    /// Multiplies the scale of every lobe, per channel.
    pub specular: Vec3,
    /// Multiplies the exponent of every lobe.
    pub exponent: f32,
}

impl Gloss {
    /// The material as it is.
    pub const NEUTRAL: Self = Self { specular: Vec3::ONE, exponent: 1.0 };

    /// A weighted sum.
    pub(crate) fn mixed(weighted: impl Iterator<Item = (Self, f32)>) -> Self {
        weighted.fold(Self { specular: Vec3::ZERO, exponent: 0.0 }, |sum, (gloss, weight)| Self {
            specular: sum.specular + weight * gloss.specular,
            exponent: sum.exponent + weight * gloss.exponent,
        })
    }

    /// The product of the factors.
    pub(crate) fn times(self, other: Self) -> Self {
        Self { specular: self.specular * other.specular, exponent: self.exponent * other.exponent }
    }
}

impl Default for Gloss {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

/// Variation of [`Gloss`] over a surface: the product of what its vertices and its textures say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GlossVariation {
    /// One per vertex of the mesh, interpolated in between; or empty.
    pub vertices: Vec<Gloss>,
    /// Multiplies the specular scale.
    pub specular: Option<Arc<Texture>>,
    /// Its red channel multiplies the exponent.
    pub exponent: Option<Arc<Texture>>,
}
