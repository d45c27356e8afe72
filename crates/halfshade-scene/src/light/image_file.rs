//! Radiance HDR and OpenEXR images, decoded to linear RGB.

mod caught;
mod exr_layers;
mod hdr;
mod open_exr;
mod primaries;
mod rgbe;

use crate::{SceneError, text};
use glam::{DMat3, Vec3};

/// The largest width or height read: 16k by 8k is the largest probe in circulation.
const LARGEST_SIDE: usize = 16384;

/// Texels that a byte of a file may stand for. Constant images shrink about a thousandfold; what claims to be larger than
/// this was cut short. With 12 bytes a texel, it bounds the memory that a lying header can ask for.
const TEXELS_PER_BYTE: usize = 4096;

/// Linear RGB, row by row from the top. Values as stored, unchecked.
#[derive(Debug, Clone)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<Vec3>,
}

/// What a file holds.
#[derive(Debug)]
pub(super) struct Decoded {
    pub(super) image: Image,
    /// From the file's primaries to Rec. 709; `None` where they are those.
    pub(super) to_rec709: Option<DMat3>,
    /// What the user should know.
    pub(super) notes: Vec<String>,
}

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

/// Refuses sizes that no file of this length holds, before memory is asked for.
fn check_size(width: usize, height: usize, bytes: usize) -> Result<(), SceneError> {
    if width == 0 || height == 0 {
        return Err(SceneError::new(format!("the image is empty: {width}x{height}")));
    }
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(SceneError::new(format!("the image is {width}x{height}; at most {LARGEST_SIDE} are read"))
            .with_remedy("reduce it: 2048x1024 resolves all but a sun"));
    }
    if width * height / TEXELS_PER_BYTE > bytes {
        let problem = format!("the image claims to be {width}x{height}, too much for {bytes} bytes");
        return Err(SceneError::new(problem).with_remedy("the file was cut short or damaged: get it again"));
    }
    Ok(())
}

/// The error of a file that ends before its picture does.
fn cut_short() -> SceneError {
    SceneError::new("the file ends before its picture does").with_remedy("it was cut short: get it again")
}
