//! Materials of a scene file.

use super::parameters::Parameters;
use crate::exchange::assembly::Assembly;
use crate::exchange::values::albedo;
use crate::texture::{Filter, Wrap};
use crate::{Material, SceneError, Texture};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

type Result<T> = std::result::Result<T, SceneError>;

/// Reflectance where pbrt's surfaces don't say, and of those that aren't read.
const DEFAULT_ALBEDO: f32 = 0.5;

/// A surface: its material, or none where a shape only bounds a medium.
pub(super) type Surface = Option<Material>;

/// The diffuse grey that pbrt begins with.
pub(super) fn default_surface() -> Surface {
    Some(Material::new(Vec3::splat(DEFAULT_ALBEDO)))
}

/// Meaning of a texture's name.
#[derive(Debug, Clone)]
pub(super) enum TextureValue {
    Constant(Vec3),
    Picture {
        texture: Arc<Texture>,
        scale: f32,
    },
    /// A kind that isn't read.
    Unread(String),
}

/// Textures by name.
pub(super) type Textures = BTreeMap<String, TextureValue>;

/// Reads what a texture's name shall stand for.
pub(super) fn texture(kind: &str, parameters: &Parameters, assembly: &mut Assembly) -> Result<TextureValue> {
    match kind {
        "constant" => {
            Ok(parameters.rgb("value").map_or_else(|| TextureValue::Unread(kind.into()), TextureValue::Constant))
        }
        "imagemap" => {
            let name = parameters.text("filename").ok_or_else(|| parameters.error("an imagemap names no file"))?;
            let path = parameters.path.parent().unwrap_or(Path::new("")).join(name);
            if !is_picture(&path) {
                return Ok(TextureValue::Unread(format!("{kind} of {name}")));
            }
            let found = Texture::load(&path).map_err(|error| match path.is_file() {
                true => error,
                false => parameters.error_at("filename", error.to_string()),
            })?;
            for name in ["encoding", "invert", "uscale", "vscale", "udelta", "vdelta", "mapping"] {
                if parameters.kind(name).is_some() {
                    assembly.note(&parameters.path, parameters.line, &format!("`{name}` of a texture left out"));
                }
            }
            let wrap = if parameters.text("wrap") == Some("clamp") { Wrap::Clamp } else { Wrap::Repeat };
            let filter = if parameters.text("filter") == Some("point") { Filter::Nearest } else { Filter::Linear };
            let texture = Arc::new(found.wrapped([wrap; 2]).filtered(filter));
            Ok(TextureValue::Picture { texture, scale: parameters.number("scale").unwrap_or(1.0) as f32 })
        }
        _ => Ok(TextureValue::Unread(kind.to_owned())),
    }
}

fn is_picture(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    matches!(ending.as_deref(), Some("png" | "jpg" | "jpeg"))
}

/// Reads a material.
pub(super) fn material(
    kind: &str,
    parameters: &Parameters,
    textures: &Textures,
    assembly: &mut Assembly,
) -> Result<Surface> {
    let (path, line) = (parameters.path.clone(), parameters.line);
    let mut note = |what: String| assembly.note(&path, line, &what);
    match kind {
        "interface" | "" => return Ok(None),
        "diffuse" => {}
        "coateddiffuse" | "diffusetransmission" => {
            note(format!("material `{kind}`: only its diffuse reflectance is read"));
        }
        _ => note(format!("material `{}` left out: diffuse, of albedo {DEFAULT_ALBEDO}", kind.escape_debug())),
    }
    let mut material = Material::new(Vec3::splat(DEFAULT_ALBEDO));
    match parameters.kind("reflectance") {
        None => {}
        Some("rgb") => material.albedo = parameters.rgb("reflectance").unwrap_or(material.albedo),
        Some("texture") => match textures.get(parameters.text("reflectance").unwrap_or_default()) {
            Some(TextureValue::Constant(color)) => material.albedo = *color,
            Some(TextureValue::Picture { texture, scale }) => {
                (material.albedo, material.texture) = (Vec3::splat(*scale), Some(texture.clone()));
            }
            Some(TextureValue::Unread(kind)) => note(format!("texture `{}` left out", kind.escape_debug())),
            None => return Err(parameters.error_at("reflectance", "no texture of that name stands before")),
        },
        Some(kind) => note(format!("reflectance by `{}` left out: {DEFAULT_ALBEDO}", kind.escape_debug())),
    }
    material.albedo = albedo(material.albedo).map_err(|problem| parameters.error_at("reflectance", problem))?;
    Ok(Some(material))
}
