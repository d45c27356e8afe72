//! Extensions of glTF: which are read, and what becomes of the others.

use crate::SceneError;
use ::gltf::json::Root;

/// Extensions that are read in full, as far as they speak of geometry and base colour.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that name images of other formats; what they name is looked at where it is used.
const IMAGES: &[&str] = &["EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"];

/// Extensions that compress vertices, which are read where the data stands beside in plain, too.
pub(super) const COMPRESSIONS: &[&str] =
    &["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Whether an extension speaks of what isn't read of any file: light, gloss, and what a surface lets through.
fn is_of_appearance(name: &str) -> bool {
    name.starts_with("KHR_materials_") || name.starts_with("KHR_lights_") || name.starts_with("KHR_xmp")
}

/// Purpose for which a document is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// Its meshes.
    Mesh,
    /// Its lights too.
    Scene,
}

/// Refuses what can't be read without its extensions; what is left out of the rest, for people.
pub(super) fn check(json: &Root, aim: Aim) -> Result<Vec<String>, SceneError> {
    let is_known = |name: &str| {
        READ.contains(&name) || IMAGES.contains(&name) || (aim == Aim::Scene && name == "KHR_lights_punctual")
    };
    for name in json.extensions_required.iter().map(String::as_str) {
        if COMPRESSIONS.contains(&name) {
            return Err(compressed(name));
        }
        if !is_known(name) && !is_of_appearance(name) {
            return Err(SceneError::new(format!("it requires the extension {name}, which isn't read"))
                .with_remedy("export it without that extension"));
        }
    }
    let mut left_out: Vec<&str> = (json.extensions_used.iter().chain(&json.extensions_required).map(String::as_str))
        .filter(|name| !is_known(name) && !COMPRESSIONS.contains(name))
        .collect();
    left_out.sort_unstable();
    left_out.dedup();
    Ok(match left_out.as_slice() {
        [] => Vec::new(),
        names => vec![format!("extensions of glTF that are not read: {}", names.join(", "))],
    })
}

/// The error of a file whose vertices are compressed.
pub(super) fn compressed(name: &str) -> SceneError {
    SceneError::new(format!("its geometry is compressed with {name}, which isn't read"))
        .with_remedy("decompress it with a program that optimizes glTF files, or export it without mesh compression")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(used: &[&str], required: &[&str]) -> Root {
        let names = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect();
        Root { extensions_used: names(used), extensions_required: names(required), ..Root::default() }
    }

    #[test]
    fn what_is_left_out_is_listed_once_and_what_is_needed_is_named() {
        assert!(
            check(&root(&["KHR_mesh_quantization", "EXT_texture_webp"], &["KHR_mesh_quantization"]), Aim::Mesh)
                .unwrap()
                .is_empty()
        );
        let lit = root(&["KHR_materials_unlit", "KHR_lights_punctual"], &["KHR_materials_unlit"]);
        let notes = check(&lit, Aim::Mesh).unwrap();
        assert_eq!(notes, ["extensions of glTF that are not read: KHR_lights_punctual, KHR_materials_unlit"]);
        assert_eq!(check(&lit, Aim::Scene).unwrap(), ["extensions of glTF that are not read: KHR_materials_unlit"]);
        let error = |name: &str| check(&root(&[], &[name]), Aim::Mesh).unwrap_err().to_string();
        for name in COMPRESSIONS {
            assert!(error(name).starts_with(&format!("its geometry is compressed with {name}")), "{}", error(name));
        }
        assert!(error("ACME_shape").contains("requires the extension ACME_shape"));
    }
}
