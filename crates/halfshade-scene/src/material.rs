//! How a surface reflects.

use crate::Texture;
use glam::Vec3;
use std::sync::Arc;

/// A diffuse surface: outgoing radiance is `albedo / π` times irradiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Reflected fraction per channel, in [0, 1]. Multiplied by the mesh's vertex colours and by a texture where there
    /// are some.
    pub albedo: Vec3,
    /// Takes the place of the mesh's own textures.
    pub texture: Option<Arc<Texture>>,
}

impl Material {
    /// A material without a texture of its own.
    pub const fn new(albedo: Vec3) -> Self {
        Self { albedo, texture: None }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::new(Vec3::ONE)
    }
}
