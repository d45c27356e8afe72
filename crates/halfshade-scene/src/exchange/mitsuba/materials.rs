//! Materials as Mitsuba's BSDFs.

use super::xml::{Xml, triple};
use crate::texture::{Filter, Wrap};
use crate::{ExrFacts, Material, Pose, Reflectance, SceneError, Texture, exr_bytes};
use glam::Vec3;
use std::sync::Arc;

/// The name under which the plugin registers.
pub(super) const PLUGIN: &str = "halfshade_lobes";

/// Surface of a part of an object.
pub(super) struct Surface<'a> {
    pub(super) material: &'a Material,
    /// Pose of the object: anisotropic lobes turn with it.
    pub(super) pose: Pose,
    /// Texture of the part, multiplied with the albedo.
    pub(super) texture: Option<&'a Arc<Texture>>,
    /// Whether vertices have colours, albedo and all.
    pub(super) has_colors: bool,
    /// Whether vertices vary the gloss.
    pub(super) has_gloss: bool,
}

/// Textures that materials name, each written once.
#[derive(Debug, Default)]
pub(super) struct Textures {
    written: Vec<(Arc<Texture>, Vec3, String)>,
    pub(super) files: Vec<(String, Vec<u8>)>,
    pub(super) notes: Vec<String>,
}

impl Textures {
    /// The file of a texture times a factor.
    fn file(&mut self, texture: &Arc<Texture>, factor: Vec3) -> Result<String, SceneError> {
        let known = self.written.iter().find(|(known, with, _)| Arc::ptr_eq(known, texture) && *with == factor);
        if let Some((_, _, name)) = known {
            return Ok(name.clone());
        }
        let name = format!("textures/{}.exr", self.written.len());
        let texels: Vec<Vec3> = texture.texels().iter().map(|texel| factor * *texel).collect();
        let bytes = exr_bytes([texture.width(), texture.height()], &[("", &texels)], ExrFacts::default())
            .map_err(SceneError::new)?;
        self.files.push((name.clone(), bytes));
        self.written.push((texture.clone(), factor, name.clone()));
        if texture.wrap()[0] != texture.wrap()[1] {
            self.notes
                .push(format!("{name}: goes on beyond its edges in two ways, of which Mitsuba gets that of rows"));
        }
        Ok(name)
    }

    /// The element of a texture times a factor, under a name.
    fn bitmap(&mut self, xml: &mut Xml, name: &str, texture: &Arc<Texture>, factor: Vec3) -> Result<(), SceneError> {
        let file = self.file(texture, factor)?;
        let wrap = match texture.wrap()[0] {
            Wrap::Repeat => "repeat",
            Wrap::Mirror => "mirror",
            Wrap::Clamp => "clamp",
        };
        xml.element("texture", &[("type", "bitmap"), ("name", name)], |xml| {
            xml.value("string", "filename", &file);
            xml.value("boolean", "raw", "true");
            let filter = if texture.filter() == Filter::Nearest { "nearest" } else { "bilinear" };
            xml.value("string", "filter_type", filter);
            xml.value("string", "wrap_mode", wrap);
        });
        Ok(())
    }
}

impl Surface<'_> {
    /// Whether Mitsuba has no BSDF for it.
    pub(super) fn needs_plugin(&self) -> bool {
        self.material.is_glossy() || (self.has_colors && self.texture.is_some())
    }

    /// Writes the BSDF.
    pub(super) fn write(&self, xml: &mut Xml, textures: &mut Textures) -> Result<(), SceneError> {
        let mut result = Ok(());
        if self.needs_plugin() {
            xml.element("bsdf", &[("type", PLUGIN)], |xml| {
                result = self.albedo(xml, textures).and_then(|()| self.gloss(xml, textures));
            });
        } else {
            xml.element("bsdf", &[("type", "twosided")], |xml| {
                xml.element("bsdf", &[("type", "diffuse")], |xml| result = self.albedo(xml, textures));
            });
        }
        result
    }

    fn albedo(&self, xml: &mut Xml, textures: &mut Textures) -> Result<(), SceneError> {
        const NAME: &str = "reflectance";
        let albedo = self.material.albedo;
        match (self.has_colors, self.texture) {
            (false, None) if self.needs_plugin() => xml.vector("vector", NAME, albedo),
            (false, None) => xml.value("rgb", NAME, &triple(albedo)),
            (false, Some(texture)) => textures.bitmap(xml, NAME, texture, albedo)?,
            (true, texture) => {
                attribute(xml, NAME, "vertex_color");
                if let Some(texture) = texture {
                    textures.bitmap(xml, "reflectance_texture", texture, Vec3::ONE)?;
                }
            }
        }
        Ok(())
    }

    fn gloss(&self, xml: &mut Xml, textures: &mut Textures) -> Result<(), SceneError> {
        match &self.material.reflectance {
            Reflectance::Lambert => {}
            Reflectance::Phong { specular, exponent } => phong(xml, "phong", *specular, *exponent),
            Reflectance::ModifiedPhong { specular, exponent } => phong(xml, "modified-phong", *specular, *exponent),
            Reflectance::Lafortune { lobes } => {
                xml.value("string", "model", "lafortune");
                for (number, lobe) in lobes.iter().enumerate() {
                    xml.vector("vector", &format!("scale_{number}"), lobe.scale);
                    xml.vector("vector", &format!("axis_{number}"), lobe.axis);
                    xml.value("float", &format!("exponent_{number}"), &lobe.exponent.to_string());
                }
                xml.vector("vector", "up", self.pose.rotation * Vec3::Y);
                xml.vector("vector", "east", self.pose.rotation * Vec3::X);
            }
        }
        if self.has_gloss {
            // Mitsuba's name for properties specular_r, specular_g, specular_b.
            attribute(xml, "specular_factor", "vertex_specular_color");
            attribute(xml, "exponent_factor", "vertex_exponent");
        }
        if let Some(variation) = self.material.gloss_variation.as_ref().filter(|_| self.material.is_glossy()) {
            let named = [("specular_texture", &variation.specular), ("exponent_texture", &variation.exponent)];
            for (name, texture) in named {
                texture.as_ref().map_or(Ok(()), |texture| textures.bitmap(xml, name, texture, Vec3::ONE))?;
            }
        }
        Ok(())
    }
}

fn phong(xml: &mut Xml, model: &str, specular: Vec3, exponent: f32) {
    xml.value("string", "model", model);
    xml.vector("vector", "specular", specular);
    xml.value("float", "exponent", &exponent.to_string());
}

/// A texture that interpolates values of vertices.
fn attribute(xml: &mut Xml, name: &str, attribute: &str) {
    xml.element("texture", &[("type", "mesh_attribute"), ("name", name)], |xml| {
        xml.value("string", "name", attribute);
    });
}
