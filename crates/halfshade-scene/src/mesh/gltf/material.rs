//! Base colour and alpha of a material.

use super::Buffers;
use super::textures::Textures;
use crate::SceneError;
use ::gltf::material::AlphaMode;
use ::gltf::texture::Info;
use ::gltf::{Material, Semantic};
use glam::{DVec2, DVec3, DVec4, Vec2};

/// Base colour and alpha of a primitive.
pub(super) struct Surface<'a> {
    /// Linear base colour and alpha, which multiply those of texture and vertices.
    pub(super) factor: DVec4,
    texture: Option<Info<'a>>,
    alpha: AlphaMode,
    cutoff: f32,
}

/// Effect of alpha on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coverage {
    /// Nothing.
    Whole,
    /// It would shine through in places, which isn't modelled.
    Blended,
    /// It is cut out by the mask of this number.
    Masked(usize),
    /// It is cut out altogether.
    Gone,
}

impl<'a> Surface<'a> {
    /// Albedo and alpha of the material that a primitive has. Where diffuse colour and gloss are given, those are read.
    pub(super) fn new(material: &Material<'a>) -> Self {
        let (factor, texture) = match material.pbr_specular_glossiness() {
            Some(surface) => (surface.diffuse_factor(), surface.diffuse_texture()),
            None => {
                let surface = material.pbr_metallic_roughness();
                (surface.base_color_factor(), surface.base_color_texture())
            }
        };
        let (alpha, cutoff) = (material.alpha_mode(), material.alpha_cutoff().unwrap_or(0.5));
        Self { factor: DVec4::from(factor.map(f64::from)), texture, alpha, cutoff }
    }

    /// Where vertices have the coordinates of its texture.
    pub(super) fn coordinates(&self) -> Option<Semantic> {
        let info = self.texture.as_ref()?;
        let set = info.texture_transform().and_then(|transform| transform.tex_coord()).unwrap_or(info.tex_coord());
        Some(Semantic::TexCoords(set))
    }

    /// A coordinate of a vertex as the texture wants it.
    pub(super) fn placed(&self, [u, v]: [f64; 2]) -> DVec2 {
        let place = DVec2::new(u, v);
        let Some(transform) = self.texture.as_ref().and_then(Info::texture_transform) else { return place };
        let (offset, scale) = (DVec2::from(transform.offset().map(f64::from)), transform.scale().map(f64::from));
        let (sin, cos) = f64::from(transform.rotation()).sin_cos();
        let scaled = place * DVec2::from(scale);
        offset + DVec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x)
    }

    /// The number of its texture, if it has one.
    pub(super) fn texture(&self, textures: &mut Textures<'_>, buffers: &Buffers) -> Result<Option<usize>, SceneError> {
        self.texture.as_ref().map(|info| textures.number(Some(info.texture()), buffers)).transpose()
    }

    /// The colour of a vertex, beside the texture.
    pub(super) fn color(&self, of_vertex: DVec4) -> DVec3 {
        (self.factor * of_vertex).truncate().clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// Effect of alpha where vertices have alpha from `least` to `most`, times the factor's.
    pub(super) fn coverage(
        &self,
        [least, most]: [f32; 2],
        textures: &mut Textures<'_>,
        buffers: &Buffers,
    ) -> Result<Coverage, SceneError> {
        if self.alpha == AlphaMode::Opaque {
            return Ok(Coverage::Whole);
        }
        let texture = self.texture.as_ref().map(Info::texture);
        let alpha = texture.map(|texture| textures.alpha(&texture, buffers)).transpose()?.flatten();
        let of_texture = alpha.as_ref().map_or(Vec2::ONE, |(_, [least, most])| Vec2::new(*least, *most));
        Ok(match self.alpha {
            AlphaMode::Blend if least * of_texture.x >= 1.0 => Coverage::Whole,
            AlphaMode::Blend => Coverage::Blended,
            _ if least * of_texture.x >= self.cutoff => Coverage::Whole,
            _ if most * of_texture.y < self.cutoff => Coverage::Gone,
            _ => Coverage::Masked(textures.mask(alpha.map(|(texture, _)| texture), self.cutoff)),
        })
    }
}
