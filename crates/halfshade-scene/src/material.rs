//! Materials: how surfaces reflect.

use crate::{GlossVariation, Reflectance, Subsurface, Texture};
use glam::Vec3;
use std::sync::Arc;

/// A surface. Its diffuse part reflects `albedo / π` times irradiance; what it reflects besides is its [`Reflectance`].
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Reflected fraction per channel, in [0, 1]. Multiplied by the mesh's vertex colours and by a texture where there
    /// are some.
    pub albedo: Vec3,
    /// Takes the place of the mesh's own textures.
    pub texture: Option<Arc<Texture>>,
    /// Reflection beside the diffuse part.
    pub reflectance: Reflectance,
    /// Variation of the reflectance over the surface, if there is any.
    pub gloss_variation: Option<Arc<GlossVariation>>,
    /// A medium below the surface, from which diffuse light comes then, tinted by the albedo.
    pub subsurface: Option<Subsurface>,
}

impl Material {
    /// A diffuse material without a texture of its own.
    pub const fn new(albedo: Vec3) -> Self {
        Self { albedo, texture: None, reflectance: Reflectance::Lambert, gloss_variation: None, subsurface: None }
    }

    /// Whether it reflects anything beside its diffuse part.
    pub fn is_glossy(&self) -> bool {
        self.reflectance.is_glossy()
    }

    /// The variation of a glossy material, if it has one.
    pub(crate) fn varied_gloss(&self) -> Option<&GlossVariation> {
        self.gloss_variation.as_deref().filter(|_| self.is_glossy())
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::new(Vec3::ONE)
    }
}
