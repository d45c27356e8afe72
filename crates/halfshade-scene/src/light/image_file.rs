//! Radiance HDR and OpenEXR images, decoded to linear RGB.

mod caught;
mod decoded;
mod exr_layers;
mod hdr;
mod open_exr;
mod primaries;
mod rgbe;

pub(super) use decoded::{Decoded, Image};

use crate::{SceneError, text};

/// Decodes Radiance HDR or OpenEXR, told apart by their first bytes. `layer` names one of an OpenEXR file.
pub(super) fn decode(bytes: &[u8], layer: Option<&str>) -> Result<Decoded, SceneError> {
    if bytes.is_empty() {
        return Err(SceneError::new("the file is empty"));
    }
    if bytes.starts_with(&exr::meta::magic_number::BYTES) {
        return open_exr::decode(bytes, layer);
    }
    let bytes = bytes.strip_prefix(text::MARK).unwrap_or(bytes);
    if !bytes.starts_with(b"#?") {
        return Err(SceneError::new("this is neither Radiance HDR, which begins with `#?`, nor OpenEXR")
            .with_remedy("get it again, or save it as one of these"));
    }
    match layer {
        Some(layer) => Err(SceneError::new(format!("a Radiance HDR file has no layers, and no layer `{layer}`"))
            .with_remedy("leave the layer out")),
        None => hdr::decode(bytes),
    }
}
