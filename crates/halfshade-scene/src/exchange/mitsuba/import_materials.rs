//! BSDFs as materials.

use super::element::{Elements, line};
use super::materials::PLUGIN;
use crate::exchange::assembly::Assembly;
use crate::exchange::values::albedo;
use crate::light::load_picture;
use crate::lobe::MAX_LOBES;
use crate::reflectance::LafortuneLobe;
use crate::texture::{Filter, Wrap};
use crate::{GlossVariation, Material, Mesh, Reflectance, SceneError, Texture};
use glam::{DVec3, Vec3};
use roxmltree::Node;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

type Result<T> = std::result::Result<T, SceneError>;

/// Reflectance of Mitsuba's surfaces that don't say.
const DEFAULT_ALBEDO: f32 = 0.5;

/// BSDFs within BSDFs that are followed.
const DEEPEST: usize = 16;

/// Textures that were read already.
#[derive(Debug, Default)]
pub(super) struct Materials {
    textures: BTreeMap<(PathBuf, bool), Arc<Texture>>,
}

impl Materials {
    /// The material of a shape. Colours of its vertices go unless the material asks for them.
    pub(super) fn of<'a, 'input>(
        &mut self,
        elements: &Elements<'a, 'input>,
        shape: Node<'a, 'input>,
        mesh: &mut Arc<Mesh>,
        assembly: &mut Assembly,
    ) -> Result<Material> {
        let mut material = Material::new(Vec3::splat(DEFAULT_ALBEDO));
        let mut has_colors = false;
        if let Some(mut bsdf) = elements.child(shape, "bsdf") {
            for _ in 0..DEEPEST {
                let kind = elements.kind(bsdf);
                let wrapper = matches!(&*kind, "twosided" | "bumpmap" | "normalmap" | "mask");
                let Some(inner) = elements.child(bsdf, "bsdf").filter(|_| wrapper) else { break };
                if kind != "twosided" {
                    assembly.note(
                        elements.path,
                        line(bsdf),
                        &format!("bsdf `{kind}` left out: what lies in it is read"),
                    );
                }
                bsdf = inner;
            }
            has_colors = self.bsdf(elements, bsdf, &mut material, mesh, assembly)?;
        }
        if !has_colors && !mesh.colors.is_empty() {
            Arc::make_mut(mesh).colors.clear();
        }
        Ok(material)
    }

    /// Reads a BSDF into `material`; whether it asks for colours of vertices.
    fn bsdf<'a, 'input>(
        &mut self,
        elements: &Elements<'a, 'input>,
        bsdf: Node<'a, 'input>,
        material: &mut Material,
        mesh: &Mesh,
        assembly: &mut Assembly,
    ) -> Result<bool> {
        let kind = elements.kind(bsdf).into_owned();
        let name = match kind.as_str() {
            "diffuse" | PLUGIN => "reflectance",
            "principled" | "principledthin" => "base_color",
            _ => "diffuse_reflectance",
        };
        let mut has_colors = false;
        match elements.property(bsdf, name).and_then(|found| elements.resolved(found)) {
            Some(texture) if texture.has_tag_name("texture") && elements.kind(texture) == "mesh_attribute" => {
                has_colors = !mesh.colors.is_empty();
                material.albedo = Vec3::ONE;
            }
            Some(texture) if texture.has_tag_name("texture") => {
                if let Some(read) = self.texture(elements, texture, mesh, assembly)? {
                    (material.albedo, material.texture) = (Vec3::ONE, Some(read));
                }
            }
            Some(_) if kind == PLUGIN => material.albedo = vector(elements, bsdf, name)?.unwrap_or(Vec3::ONE),
            Some(_) => material.albedo = elements.color(bsdf, name)?.unwrap_or(material.albedo),
            None => {}
        }
        material.albedo = albedo(material.albedo).map_err(|problem| elements.error(bsdf, problem))?;
        match kind.as_str() {
            "diffuse" => {}
            "phong" => {
                let specular = elements.color(bsdf, "specular_reflectance")?.unwrap_or(Vec3::splat(0.2));
                let exponent = elements.number(bsdf, "exponent")?.unwrap_or(30.0) as f32;
                material.reflectance = Reflectance::ModifiedPhong { specular, exponent };
            }
            PLUGIN => {
                material.reflectance = lobes(elements, bsdf)?;
                self.variation(elements, bsdf, material, mesh, assembly)?;
            }
            _ => {
                let note = format!("bsdf `{kind}` left out: diffuse, of albedo {}", material.albedo);
                assembly.note(elements.path, line(bsdf), &note);
            }
        }
        let most = if material.texture.is_some() || has_colors { Vec3::ZERO } else { material.albedo };
        material.reflectance.validate(most).map_err(|error| elements.error(bsdf, error.problem))?;
        Ok(has_colors)
    }

    /// Textures of the plugin beside that of the albedo.
    fn variation<'a, 'input>(
        &mut self,
        elements: &Elements<'a, 'input>,
        bsdf: Node<'a, 'input>,
        material: &mut Material,
        mesh: &Mesh,
        assembly: &mut Assembly,
    ) -> Result<()> {
        let mut read = |name: &str| match elements.property(bsdf, name).and_then(|found| elements.resolved(found)) {
            Some(texture) => self.texture(elements, texture, mesh, assembly),
            None => Ok(None),
        };
        if let Some(texture) = read("reflectance_texture")? {
            material.texture = Some(texture);
        }
        let (specular, exponent) = (read("specular_texture")?, read("exponent_texture")?);
        // Only a note: vertices that vary gloss have no place in mesh files that are read.
        read("specular_factor")?;
        read("exponent_factor")?;
        if specular.is_some() || exponent.is_some() {
            material.gloss_variation = Some(Arc::new(GlossVariation { vertices: Vec::new(), specular, exponent }));
        }
        Ok(())
    }

    /// A texture, or a note that it is left out.
    fn texture<'a, 'input>(
        &mut self,
        elements: &Elements<'a, 'input>,
        node: Node<'a, 'input>,
        mesh: &Mesh,
        assembly: &mut Assembly,
    ) -> Result<Option<Arc<Texture>>> {
        let kind = elements.kind(node);
        if kind != "bitmap" || mesh.texture_coordinates.is_empty() {
            let why = if kind == "bitmap" { ": the shape has no texture coordinates" } else { "" };
            assembly.note(elements.path, line(node), &format!("texture `{kind}` left out{why}"));
            return Ok(None);
        }
        if elements.property(node, "to_uv").is_some() {
            assembly.note(elements.path, line(node), "`to_uv` of a texture left out");
        }
        let name = elements.text(node, "filename").ok_or_else(|| elements.error(node, "a texture names no file"))?;
        let path = elements.path.parent().map_or_else(|| (&name).into(), |folder| folder.join(&name));
        let is_raw = elements.flag(node, "raw") == Some(true);
        let key = (path, is_raw);
        let texture = match self.textures.get(&key) {
            Some(known) => known.clone(),
            None => {
                let found = picture(&key.0).map_err(|error| match key.0.is_file() {
                    true => error,
                    false => elements.error(node, error.to_string()),
                })?;
                let texture = Arc::new(found);
                self.textures.insert(key, texture.clone());
                texture
            }
        };
        let wrap = match elements.text(node, "wrap_mode").as_deref() {
            Some("mirror") => Wrap::Mirror,
            Some("clamp") => Wrap::Clamp,
            _ => Wrap::Repeat,
        };
        let is_nearest = elements.text(node, "filter_type").as_deref() == Some("nearest");
        let filter = if is_nearest { Filter::Nearest } else { Filter::Linear };
        if (texture.wrap(), texture.filter()) == ([wrap; 2], filter) {
            return Ok(Some(texture));
        }
        Ok(Some(Arc::new(Texture::clone(&texture).wrapped([wrap; 2]).filtered(filter))))
    }
}

/// A picture whose values are in [0, 1].
fn picture(path: &std::path::Path) -> Result<Texture> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("exr" | "hdr" | "pic") => {
            let ([width, height], texels, _) = load_picture(path)?;
            Texture::new(width, height, texels).map_err(|error| error.in_file(path))
        }
        _ => Texture::load(path),
    }
}

fn vector<'a, 'input>(elements: &Elements<'a, 'input>, node: Node<'a, 'input>, name: &str) -> Result<Option<Vec3>> {
    let vector = elements.property(node, name).map(|found| elements.vector(found, 0.0)).transpose()?;
    Ok(vector.map(|vector: DVec3| vector.as_vec3()))
}

/// Reflection of the plugin beside the diffuse part.
fn lobes<'a, 'input>(elements: &Elements<'a, 'input>, bsdf: Node<'a, 'input>) -> Result<Reflectance> {
    let exponent = |name: &str| Ok(elements.number(bsdf, name)?.unwrap_or(1.0) as f32);
    let specular = || Ok(vector(elements, bsdf, "specular")?.unwrap_or(Vec3::ZERO));
    match elements.text(bsdf, "model").as_deref() {
        Some("phong") => Ok(Reflectance::Phong { specular: specular()?, exponent: exponent("exponent")? }),
        Some("modified-phong") => {
            Ok(Reflectance::ModifiedPhong { specular: specular()?, exponent: exponent("exponent")? })
        }
        Some("lafortune") => {
            let mut lobes = Vec::new();
            // One more than there may be is enough to be refused.
            for number in 0..=MAX_LOBES {
                let Some(axis) = vector(elements, bsdf, &format!("axis_{number}"))? else { break };
                let scale = vector(elements, bsdf, &format!("scale_{number}"))?.unwrap_or(Vec3::ZERO);
                lobes.push(LafortuneLobe { scale, axis, exponent: exponent(&format!("exponent_{number}"))? });
            }
            Ok(Reflectance::Lafortune { lobes })
        }
        _ => Ok(Reflectance::Lambert),
    }
}
